#include "stages/export/ros.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "stages/error.hpp"
#include "stages/export/text.hpp"
#include "stages/geometry/pose.hpp"

/// ROS 2: the waypoints as geometry_msgs/PoseArray and, with times and velocities, as
/// trajectory_msgs/MultiDOFJointTrajectory of the tool, and, where the plan has an arm, its axes all along as
/// trajectory_msgs/JointTrajectory; each as YAML and in an MCAP bag, there also the arc, as std_msgs/Bool. Metres, rad,
/// quaternions x, y, z, w. A time stamp of 0, so that the YAML fits ROS 1 as well, says nothing of when. The way to the
/// first pose is left to the planner.
namespace seampath::exporting {
namespace ros_writer {

constexpr std::size_t kMaxName = 64;
constexpr double kRounding_mm = 5e-10;  // of the YAML: twelve decimals of a metre

std::string message(std::string_view type, std::string_view fields) {
    std::string text(80, '=');
    return text.append("\nMSG: ").append(type).append("\n").append(fields);
}

std::vector<BagTopic> topics(bool with_axes) {
    static const std::string duration = message("builtin_interfaces/Duration", "int32 sec\nuint32 nanosec\n");
    static const std::string header = message("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n") +
                                      message("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n");
    static const std::string vector3 = message("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n");
    static const std::string quaternion =
        message("geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n");
    static const std::vector<BagTopic> all{
        {"/seampath/poses", "geometry_msgs/msg/PoseArray",
         "std_msgs/Header header\ngeometry_msgs/Pose[] poses\n" + header +
             message("geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n") +
             message("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n") + quaternion},
        {"/seampath/trajectory", "trajectory_msgs/msg/MultiDOFJointTrajectory",
         "std_msgs/Header header\nstring[] joint_names\ntrajectory_msgs/MultiDOFJointTrajectoryPoint[] points\n" +
             header +
             message("trajectory_msgs/MultiDOFJointTrajectoryPoint",
                     "geometry_msgs/Transform[] transforms\ngeometry_msgs/Twist[] velocities\n"
                     "geometry_msgs/Twist[] accelerations\nbuiltin_interfaces/Duration time_from_start\n") +
             message("geometry_msgs/Transform",
                     "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n") +
             message("geometry_msgs/Twist", "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n") + vector3 +
             quaternion + duration},
        {"/seampath/arc", "std_msgs/msg/Bool", "bool data\n"},
        {"/seampath/joint_trajectory", "trajectory_msgs/msg/JointTrajectory",
         "std_msgs/Header header\nstring[] joint_names\ntrajectory_msgs/JointTrajectoryPoint[] points\n" + header +
             message("trajectory_msgs/JointTrajectoryPoint",
                     "float64[] positions\nfloat64[] velocities\nfloat64[] accelerations\nfloat64[] effort\n"
                     "builtin_interfaces/Duration time_from_start\n") +
             duration}};
    return {all.begin(), all.end() - (with_axes ? 0 : 1)};
}

// A waypoint as the trajectory has it: SI units.
struct Point {
    Eigen::Vector3d p, linear, angular;
    Eigen::Quaterniond q;
    std::int64_t time_ns = 0;
};

// Velocities are those of the move that ends here; none leads to the first. Times go on by a nanosecond at least, where
// the torch turns on the spot.
std::vector<Point> points_of(const std::vector<Target>& targets) {
    std::vector<Point> points;
    for (const Target& target : targets) {
        const Waypoint& w = target.at;
        Point point{w.p / 1000, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), w.q, 0};
        if (!points.empty()) {
            const Point& last = points.back();
            point.time_ns = std::max<std::int64_t>(std::llround(w.time_s * 1e9), last.time_ns + 1);
            const Eigen::Vector3d along = point.p - last.p;
            const double length = along.norm();
            // On the spot the speed has no direction of its own: that of the travel.
            point.linear =
                w.speed_mm_s / 1000 * (length > 0 ? Eigen::Vector3d(along / length) : w.q * Eigen::Vector3d::UnitX());
            const double seconds = static_cast<double>(point.time_ns - last.time_ns) * 1e-9;
            point.angular = seconds > 1e-6 ? Eigen::Vector3d(rotation_vector(w.q * last.q.conjugate()) / seconds)
                                           : Eigen::Vector3d::Zero();
        }
        points.push_back(point);
    }
    return points;
}

std::string map_of(const Eigen::Vector3d& v) {
    return "{x: " + fixed(v.x(), 12) + ", y: " + fixed(v.y(), 12) + ", z: " + fixed(v.z(), 12) + "}";
}

std::string map_of(const Eigen::Quaterniond& q) {
    return "{x: " + fixed(q.x(), 12) + ", y: " + fixed(q.y(), 12) + ", z: " + fixed(q.z(), 12) +
           ", w: " + fixed(q.w(), 12) + "}";
}

constexpr std::int64_t kSecond = 1000000000;

std::string poses_yaml(const std::string& head, const std::vector<Point>& points) {
    std::string text = head + "poses:\n";
    for (const Point& point : points) {
        text += "- {position: " + map_of(point.p) + ", orientation: " + map_of(point.q) + "}\n";
    }
    return text;
}

std::string trajectory_yaml(const std::string& head, const std::vector<Point>& points) {
    std::string text = head + "joint_names: [tool]\npoints:\n";
    for (const Point& point : points) {
        text += "- {transforms: [{translation: " + map_of(point.p) + ", rotation: " + map_of(point.q) +
                "}], velocities: [{linear: " + map_of(point.linear) + ", angular: " + map_of(point.angular) +
                "}], accelerations: [], time_from_start: {sec: " + std::to_string(point.time_ns / kSecond) +
                ", nanosec: " + std::to_string(point.time_ns % kSecond) + "}}\n";
    }
    return text;
}

std::int64_t nanoseconds(const AxisPoint& point) {
    return std::llround(point.time_s * 1e9);
}

std::string list_of(const std::array<double, 6>& values) {
    std::vector<std::string> texts;
    for (const double value : values) {
        texts.push_back(fixed(value, 12));
    }
    return "[" + joined(texts, ", ") + "]";
}

std::string joints_yaml(const std::string& head, const std::vector<std::string>& joints,
                        const std::vector<AxisPoint>& travel) {
    std::string text = head + "joint_names: [" + joined(joints, ", ") + "]\npoints:\n";
    for (const AxisPoint& point : travel) {
        const std::int64_t ns = nanoseconds(point);
        text += "- {positions: " + list_of(point.q) + ", velocities: " + list_of(point.dq) +
                ", accelerations: [], effort: [], time_from_start: {sec: " + std::to_string(ns / kSecond) +
                ", nanosec: " + std::to_string(ns % kSecond) + "}}\n";
    }
    return text;
}

// Common data representation, little-endian: numbers at multiples of their size, counted behind the first four bytes.
class Cdr {
public:
    std::string data = std::string("\0\1\0\0", 4);

    template <class Number>
    void number(Number value) {
        data.append((sizeof value - (data.size() - 4) % sizeof value) % sizeof value, '\0');
        data.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    void text(const std::string& value) {
        number(static_cast<std::uint32_t>(value.size() + 1));
        data.append(value.c_str(), value.size() + 1);
    }
    void vector(const Eigen::Vector3d& v) {
        for (int i = 0; i < 3; ++i) {
            number(v[i]);
        }
    }
    void quaternion(const Eigen::Quaterniond& q) {
        for (const double value : {q.x(), q.y(), q.z(), q.w()}) {
            number(value);
        }
    }
    void size(std::size_t count) { number(static_cast<std::uint32_t>(count)); }
    void header(const std::string& frame) {
        number(std::int32_t{0});
        number(std::uint32_t{0});
        text(frame);
    }
};

std::string poses_cdr(const std::string& frame, const std::vector<Point>& points) {
    Cdr cdr;
    cdr.header(frame);
    cdr.size(points.size());
    for (const Point& point : points) {
        cdr.vector(point.p);
        cdr.quaternion(point.q);
    }
    return cdr.data;
}

std::string trajectory_cdr(const std::string& frame, const std::vector<Point>& points) {
    Cdr cdr;
    cdr.header(frame);
    cdr.size(1);
    cdr.text("tool");
    cdr.size(points.size());
    for (const Point& point : points) {
        cdr.size(1);
        cdr.vector(point.p);
        cdr.quaternion(point.q);
        cdr.size(1);
        cdr.vector(point.linear);
        cdr.vector(point.angular);
        cdr.size(0);
        cdr.number(static_cast<std::int32_t>(point.time_ns / kSecond));
        cdr.number(static_cast<std::uint32_t>(point.time_ns % kSecond));
    }
    return cdr.data;
}

std::string joints_cdr(const std::string& frame, const std::vector<std::string>& joints,
                       const std::vector<AxisPoint>& travel) {
    Cdr cdr;
    cdr.header(frame);
    cdr.size(joints.size());
    for (const std::string& joint : joints) {
        cdr.text(joint);
    }
    cdr.size(travel.size());
    for (const AxisPoint& point : travel) {
        for (const auto& values : {point.q, point.dq}) {
            cdr.size(values.size());
            for (const double value : values) {
                cdr.number(value);
            }
        }
        cdr.size(0);
        cdr.size(0);
        const std::int64_t ns = nanoseconds(point);
        cdr.number(static_cast<std::int32_t>(ns / kSecond));
        cdr.number(static_cast<std::uint32_t>(ns % kSecond));
    }
    return cdr.data;
}

std::string bool_cdr(bool value) {
    Cdr cdr;
    cdr.number(static_cast<std::uint8_t>(value ? 1 : 0));
    return cdr.data;
}

// The arc's changes, at the times of the trajectories.
void add_arc(std::vector<BagMessage>& messages, const std::vector<Target>& targets, const std::vector<Point>& points) {
    for (std::size_t k = 0; k < targets.size(); ++k) {
        const WaypointKind kind = targets[k].at.kind;
        if (kind == WaypointKind::weld_start || kind == WaypointKind::weld_end) {
            messages.push_back(
                {2, static_cast<std::uint64_t>(points[k].time_ns), bool_cdr(kind == WaypointKind::weld_start)});
        }
    }
}

bool is_name(std::string name) {
    std::replace(name.begin(), name.end(), '/', '_');
    return is_identifier(name);
}

// Between commas; blanks around them do not count.
std::vector<std::string> names_of(const std::string& list) {
    std::vector<std::string> names(1);
    for (const char c : list) {
        if (c == ',') {
            names.emplace_back();
        } else if (c != ' ') {
            names.back() += c;
        }
    }
    return names;
}

Told told(const ExportOptions&) {
    return Told::welding;
}

std::vector<std::string> problems(const ExportOptions& options) {
    std::vector<std::string> found = name_problems("program_name", options.program_name, kMaxName, {}, "ROS");
    if (!is_name(options.ros_frame)) {
        found.push_back("ros_frame: \"" + options.ros_frame +
                        "\" is no frame; a letter was needed, then letters, digits, underscores and slashes");
    }
    const std::vector<std::string> joints = names_of(options.arm_joints);
    if (!options.arm_joints.empty() && !(joints.size() == 6 && std::all_of(joints.begin(), joints.end(), is_name))) {
        found.push_back("arm_joints: \"" + options.arm_joints +
                        "\" are no joints; six names of letters, digits, underscores and slashes were needed, with "
                        "commas between them");
    }
    return found;
}

std::vector<TextFile> write(const Program& program, const ExportOptions& options) {
    const std::vector<Point> points = points_of(program.targets);
    std::string head;
    for (const std::string& line : preamble(program, options, kRounding_mm)) {
        head += "# " + line + "\n";
    }
    head += "header: {frame_id: " + options.ros_frame + "}\n";
    const std::string& name = options.program_name;
    std::vector<TextFile> files{{name + "_poses.yaml", poses_yaml(head, points)},
                                {name + "_trajectory.yaml", trajectory_yaml(head, points)}};
    const std::string& frame = options.ros_frame;
    std::vector<BagMessage> messages{{0, 0, poses_cdr(frame, points)}, {1, 0, trajectory_cdr(frame, points)}};
    std::vector<AxisPoint> travel;
    for (const Target& target : program.targets) {
        travel.insert(travel.end(), target.axes.begin(), target.axes.end());
    }
    if (!travel.empty()) {
        if (options.arm_joints.empty()) {
            throw InputError(
                "export: ros: the plan has an arm whose joints have no names; six were needed; set export.arm_joints");
        }
        const std::vector<std::string> joints = names_of(options.arm_joints);
        files.push_back({name + "_joints.yaml", joints_yaml(head, joints, travel)});
        messages.push_back({3, 0, joints_cdr(frame, joints, travel)});
    }
    add_arc(messages, program.targets, points);
    files.push_back({name + ".mcap", write_mcap(topics(!travel.empty()), messages)});
    return files;
}

}  // namespace ros_writer

constinit const Format kRos{"ros",
                            ros_writer::kRounding_mm,
                            kAnywhere,
                            1e-6,
                            true,
                            false,
                            Axes::all,
                            true,
                            ros_writer::told,
                            ros_writer::problems,
                            ros_writer::write,
                            read_ros};

}  // namespace seampath::exporting
