#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <string>

#include "stages/error.hpp"
#include "stages/export/ros.hpp"
#include "stages/export/text.hpp"
#include "stages/export/yaml.hpp"

/// Reads what subscribers would get: both messages from YAML (maps, lists, numbers and words) and from the bag by the
/// fields of their types, which must agree; times of the arc from the bag. Speeds are the trajectory's velocities, and
/// must be what lengths and times say.
namespace seampath::exporting {
namespace ros_reader {

struct Pose {
    Eigen::Vector3d p;
    Eigen::Quaterniond q;
};

struct Point {
    Pose pose;
    Eigen::Vector3d linear;
    double time_s = 0;
};

struct Messages {
    std::string frame;
    std::vector<Pose> poses;
    std::vector<Point> points;
    std::vector<std::string> joints;  // of the arm, where there is one
    std::vector<AxisPoint> travel;
};

void require(bool holds, const std::string& needed) {
    if (!holds) {
        throw InternalError("export: ros: " + needed + " was needed");
    }
}

Eigen::Vector3d vector_of(const Yaml& v) {
    require(v.members.size() == 3, "three fields of a vector");
    return {v["x"].number, v["y"].number, v["z"].number};
}

Eigen::Quaterniond quaternion_of(const Yaml& v) {
    require(v.members.size() == 4, "four fields of a quaternion");
    return {v["w"].number, v["x"].number, v["y"].number, v["z"].number};
}

const Yaml& only(const Yaml& list) {
    require(list.items.size() == 1, "one joint");
    return list.items.front();
}

double time_of(const Yaml& duration) {
    const double sec = duration["sec"].number, nanosec = duration["nanosec"].number;
    require(sec == std::floor(sec) && nanosec == std::floor(nanosec) && nanosec >= 0 && nanosec < 1e9,
            "whole seconds and nanoseconds");
    return sec + 1e-9 * nanosec;
}

std::array<double, 6> six_of(const Yaml& list) {
    require(list.items.size() == 6, "six axes");
    std::array<double, 6> values{};
    std::transform(list.items.begin(), list.items.end(), values.begin(), [](const Yaml& v) { return v.number; });
    return values;
}

void add_joints(const TextFile& file, Messages& to) {
    const Yaml way = yaml_document(file);
    require(way.members.size() == 3 && way["header"]["frame_id"].word == to.frame,
            "one frame, and the fields of the message and no others");
    for (const Yaml& name : way["joint_names"].items) {
        to.joints.push_back(name.word);
    }
    for (const Yaml& point : way["points"].items) {
        require(point.members.size() == 5 && point["accelerations"].items.empty() && point["effort"].items.empty(),
                "positions, velocities and times, and empty accelerations and efforts");
        to.travel.push_back(
            {time_of(point["time_from_start"]), six_of(point["positions"]), six_of(point["velocities"])});
    }
}

Messages from_yaml(const TextFile& poses, const TextFile& trajectory) {
    const Yaml array = yaml_document(poses), way = yaml_document(trajectory);
    require(array.members.size() == 2 && way.members.size() == 3, "the fields of the messages and no others");
    Messages result;
    result.frame = array["header"]["frame_id"].word;
    require(way["header"]["frame_id"].word == result.frame && only(way["joint_names"]).word == "tool",
            "one frame, and the joint \"tool\"");
    for (const Yaml& pose : array["poses"].items) {
        result.poses.push_back({vector_of(pose["position"]), quaternion_of(pose["orientation"])});
    }
    for (const Yaml& point : way["points"].items) {
        const Yaml &transform = only(point["transforms"]), &twist = only(point["velocities"]);
        require(point["accelerations"].items.empty(), "no accelerations");
        vector_of(twist["angular"]);
        result.points.push_back({{vector_of(transform["translation"]), quaternion_of(transform["rotation"])},
                                 vector_of(twist["linear"]),
                                 time_of(point["time_from_start"])});
    }
    return result;
}

// CDR by the rules of XCDR 1: little-endian as the first bytes say, every number at a multiple of its size.
class Cdr {
public:
    explicit Cdr(const std::string& data) : data_(data) {
        require(data.size() >= 4 && data.compare(0, 4, std::string("\0\1\0\0", 4)) == 0, "plain little-endian CDR");
    }
    template <class Number>
    Number number() {
        while ((at_ - 4) % sizeof(Number) != 0) {
            require(at_ < data_.size() && data_[at_] == 0, "padding");
            ++at_;
        }
        require(data_.size() - at_ >= sizeof(Number), "as many bytes as the type has");
        Number value;
        std::memcpy(&value, data_.data() + at_, sizeof value);
        at_ += sizeof value;
        return value;
    }
    std::string text() {
        const auto size = number<std::uint32_t>();
        require(size >= 1 && size <= data_.size() - at_ && data_[at_ + size - 1] == 0, "a text that ends in a zero");
        std::string result = data_.substr(at_, size - 1);
        at_ += size;
        return result;
    }
    Eigen::Vector3d vector() {
        const double x = number<double>(), y = number<double>(), z = number<double>();
        return {x, y, z};
    }
    Eigen::Quaterniond quaternion() {
        const double x = number<double>(), y = number<double>(), z = number<double>(), w = number<double>();
        return {w, x, y, z};
    }
    std::array<double, 6> six() {
        require(number<std::uint32_t>() == 6, "six axes");
        std::array<double, 6> values{};
        for (double& value : values) {
            value = number<double>();
        }
        return values;
    }
    double time() {
        const auto sec = number<std::int32_t>();
        return sec + 1e-9 * number<std::uint32_t>();
    }
    std::string header() {
        number<std::int32_t>();
        number<std::uint32_t>();
        return text();
    }
    void one() { require(number<std::uint32_t>() == 1, "one joint"); }
    void end() const { require(at_ == data_.size(), "the end of the message"); }

private:
    const std::string& data_;
    std::size_t at_ = 4;
};

void add_joints(const std::string& message, Messages& to) {
    Cdr way(message);
    require(way.header() == to.frame, "one frame");
    for (auto left = way.number<std::uint32_t>(); left > 0; --left) {
        to.joints.push_back(way.text());
    }
    for (auto left = way.number<std::uint32_t>(); left > 0; --left) {
        AxisPoint point;
        point.q = way.six();
        point.dq = way.six();
        require(way.number<std::uint32_t>() == 0 && way.number<std::uint32_t>() == 0, "no accelerations and efforts");
        point.time_s = way.time();
        to.travel.push_back(point);
    }
    way.end();
}

Messages from_bag(const Bag& bag) {
    const bool arm = bag.topics.size() == 4 && bag.topics[3].type == "trajectory_msgs/msg/JointTrajectory";
    require((bag.topics.size() == 3 || arm) && bag.topics[0].type == "geometry_msgs/msg/PoseArray" &&
                bag.topics[1].type == "trajectory_msgs/msg/MultiDOFJointTrajectory" &&
                bag.topics[2].type == "std_msgs/msg/Bool",
            "topics of poses, trajectory, arc and, of an arm, its trajectory");
    require(bag.messages.size() >= 2 && bag.messages[0].channel == 0 && bag.messages[1].channel == 1,
            "poses and trajectory first");
    Messages result;
    Cdr poses(bag.messages[0].data), way(bag.messages[1].data);
    result.frame = poses.header();
    for (auto left = poses.number<std::uint32_t>(); left > 0; --left) {
        const Eigen::Vector3d p = poses.vector();
        result.poses.push_back({p, poses.quaternion()});
    }
    poses.end();
    require(way.header() == result.frame, "one frame");
    way.one();
    require(way.text() == "tool", "the joint \"tool\"");
    for (auto left = way.number<std::uint32_t>(); left > 0; --left) {
        Point point;
        way.one();
        point.pose.p = way.vector();
        point.pose.q = way.quaternion();
        way.one();
        point.linear = way.vector();
        way.vector();
        require(way.number<std::uint32_t>() == 0, "no accelerations");
        point.time_s = way.time();
        result.points.push_back(point);
    }
    way.end();
    if (arm) {
        require(bag.messages.size() >= 3 && bag.messages[2].channel == 3, "the arm's trajectory third");
        add_joints(bag.messages[2].data, result);
    }
    return result;
}

bool same(const Pose& a, const Pose& b) {
    return (a.p - b.p).cwiseAbs().maxCoeff() <= 1e-12 && (a.q.coeffs() - b.q.coeffs()).cwiseAbs().maxCoeff() <= 1e-12;
}

void require_same(const Messages& yaml, const Messages& bag) {
    require(yaml.frame == bag.frame && yaml.poses.size() == bag.poses.size() &&
                yaml.points.size() == bag.points.size() && yaml.poses.size() == yaml.points.size(),
            "one frame, and as many poses in each file");
    for (std::size_t k = 0; k < yaml.poses.size(); ++k) {
        const Point &a = yaml.points[k], &b = bag.points[k];
        require(same(yaml.poses[k], bag.poses[k]) && same(yaml.poses[k], a.pose) && same(a.pose, b.pose),
                "the same pose " + std::to_string(k) + " in all messages");
        require((a.linear - b.linear).norm() <= 1e-11 && std::abs(a.time_s - b.time_s) <= 1e-9,
                "the same speed and time " + std::to_string(k) + " in all messages");
    }
    require(yaml.joints == bag.joints && yaml.travel.size() == bag.travel.size(), "one arm, and as many points of it");
    for (std::size_t k = 0; k < yaml.travel.size(); ++k) {
        const AxisPoint &a = yaml.travel[k], &b = bag.travel[k];
        bool equal = std::abs(a.time_s - b.time_s) <= 1e-9;
        for (std::size_t i = 0; i < a.q.size(); ++i) {
            equal = equal && std::abs(a.q[i] - b.q[i]) <= 1e-12 && std::abs(a.dq[i] - b.dq[i]) <= 1e-12;
        }
        require(equal, "the same axes " + std::to_string(k) + " in both messages");
    }
}

// What lengths and times say, where there is enough of both to tell.
void require_speed(const Point& from, const Point& to) {
    const double seconds = to.time_s - from.time_s, length = (to.pose.p - from.pose.p).norm();
    require(seconds > 0, "times that go on");
    if (seconds > 1e-5 && length > 1e-8) {
        require(std::abs(length / seconds / to.linear.norm() - 1) < 0.005, "velocities that lengths and times have");
    }
}

// The arm's points up to each of the tool's, at whose time the last of them is.
void share_travel(const std::vector<AxisPoint>& travel, const std::vector<Point>& points,
                  std::vector<Target>& targets) {
    std::size_t next = 0;
    for (std::size_t k = 0; k < points.size() && !travel.empty(); ++k) {
        for (bool there = false; !there; ++next) {
            require(next < travel.size() && travel[next].time_s <= points[k].time_s &&
                        (next == 0 || travel[next].time_s > travel[next - 1].time_s),
                    "the arm at every pose when the tool is, and times that go on");
            targets[k].axes.push_back(travel[next]);
            there = travel[next].time_s == points[k].time_s;
        }
    }
    require(next == travel.size(), "the arm's end with the tool's");
}

}  // namespace ros_reader

std::vector<Target> read_ros(const std::vector<TextFile>& files) {
    using namespace ros_reader;
    require(files.size() == 3 || files.size() == 4, "three files, or four with an arm");
    Messages yaml = from_yaml(files[0], files[1]);
    if (files.size() == 4) {
        add_joints(files[2], yaml);
        require(yaml.joints.size() == 6 && !yaml.travel.empty(), "the names of six joints, and points");
    }
    const Bag bag = read_mcap(files.back().text, files.back().name);
    require_same(yaml, from_bag(bag));
    std::vector<Target> targets;
    std::size_t event = files.size() - 1;
    bool arc = false;
    for (std::size_t k = 0; k < yaml.points.size(); ++k) {
        const Point& point = yaml.points[k];
        if (k > 0) {
            require_speed(yaml.points[k - 1], point);
        }
        Target target;
        target.move = k == 0 ? Move::joint : Move::linear;
        target.at.p = 1000 * point.pose.p;
        target.at.q = point.pose.q.normalized();
        require(std::abs(point.pose.q.norm() - 1) < 1e-9, "unit quaternions");
        target.at.speed_mm_s = k == 0 ? std::numeric_limits<double>::quiet_NaN() : 1000 * point.linear.norm();
        target.at.kind = arc ? WaypointKind::weld : WaypointKind::air;
        if (event < bag.messages.size() &&
            std::abs(static_cast<double>(bag.messages[event].time_ns) - 1e9 * point.time_s) < 1) {
            Cdr state(bag.messages[event].data);
            const auto on = state.number<std::uint8_t>();
            state.end();
            require(bag.messages[event].channel == 2 && on == (arc ? 0 : 1), "the arc on and off in turn");
            target.at.kind = arc ? WaypointKind::weld_end : WaypointKind::weld_start;
            arc = !arc;
            ++event;
        }
        targets.push_back(target);
    }
    require(event == bag.messages.size() && !arc, "the arc to change at poses, and to end");
    share_travel(yaml.travel, yaml.points, targets);
    return targets;
}

}  // namespace seampath::exporting
