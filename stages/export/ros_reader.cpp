#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <string>

#include "stages/error.hpp"
#include "stages/export/ros.hpp"
#include "stages/export/text.hpp"

/// Reads what subscribers would get: both messages from YAML (maps, lists, numbers and words) and from the bag by the
/// fields of their types, which must agree; times of the arc from the bag. Speeds are the trajectory's velocities, and
/// must be what lengths and times say.
namespace seampath::exporting {
namespace {

// YAML in flow style: a number, a word, a map or a list.
struct Value {
    double number = std::numeric_limits<double>::quiet_NaN();
    std::string word;
    std::map<std::string, Value> members;
    std::vector<Value> items;

    const Value& operator[](const std::string& name) const {
        const auto found = members.find(name);
        if (found == members.end()) {
            throw InternalError("export: ros: a field " + name + " was needed");
        }
        return found->second;
    }
};

std::string path_word(Scanner& scan) {
    std::string word = scan.name();
    while (scan.accept('/')) {
        word += "/" + scan.name();
    }
    return word;
}

Value value(Scanner& scan) {
    Value result;
    if (scan.accept('{')) {
        do {
            const std::string name = scan.name();
            scan.expect(':');
            if (!result.members.emplace(name, value(scan)).second) {
                scan.fail("each field once before this place");
            }
        } while (scan.accept(','));
        scan.expect('}');
    } else if (scan.accept('[')) {
        if (!scan.accept(']')) {
            do {
                result.items.push_back(value(scan));
            } while (scan.accept(','));
            scan.expect(']');
        }
    } else if (scan.at_name()) {
        result.word = path_word(scan);
    } else {
        result.number = scan.decimal();
    }
    return result;
}

// Keys at the margin, each with a value or a list of lines that begin with a dash.
Value document(const TextFile& file) {
    Scanner scan(file, '#');
    Value root;
    while (!scan.done()) {
        const std::string name = scan.name();
        scan.expect(':');
        Value member;
        if (scan.accept('-')) {
            do {
                member.items.push_back(value(scan));
            } while (scan.accept('-'));
        } else {
            member = value(scan);
        }
        if (!root.members.emplace(name, member).second) {
            scan.fail("each field once before this place");
        }
    }
    return root;
}

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
};

void require(bool holds, const std::string& needed) {
    if (!holds) {
        throw InternalError("export: ros: " + needed + " was needed");
    }
}

Eigen::Vector3d vector_of(const Value& v) {
    require(v.members.size() == 3, "three fields of a vector");
    return {v["x"].number, v["y"].number, v["z"].number};
}

Eigen::Quaterniond quaternion_of(const Value& v) {
    require(v.members.size() == 4, "four fields of a quaternion");
    return {v["w"].number, v["x"].number, v["y"].number, v["z"].number};
}

const Value& only(const Value& list) {
    require(list.items.size() == 1, "one joint");
    return list.items.front();
}

Messages from_yaml(const TextFile& poses, const TextFile& trajectory) {
    const Value array = document(poses), way = document(trajectory);
    require(array.members.size() == 2 && way.members.size() == 3, "the fields of the messages and no others");
    Messages result;
    result.frame = array["header"]["frame_id"].word;
    require(way["header"]["frame_id"].word == result.frame && only(way["joint_names"]).word == "tool",
            "one frame, and the joint \"tool\"");
    for (const Value& pose : array["poses"].items) {
        result.poses.push_back({vector_of(pose["position"]), quaternion_of(pose["orientation"])});
    }
    for (const Value& point : way["points"].items) {
        const Value &transform = only(point["transforms"]), &twist = only(point["velocities"]);
        require(point["accelerations"].items.empty(), "no accelerations");
        vector_of(twist["angular"]);
        const double sec = point["time_from_start"]["sec"].number, nanosec = point["time_from_start"]["nanosec"].number;
        require(sec == std::floor(sec) && nanosec == std::floor(nanosec) && nanosec >= 0 && nanosec < 1e9,
                "whole seconds and nanoseconds");
        result.points.push_back({{vector_of(transform["translation"]), quaternion_of(transform["rotation"])},
                                 vector_of(twist["linear"]),
                                 sec + 1e-9 * nanosec});
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
        const std::string result = data_.substr(at_, size - 1);
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

Messages from_bag(const Bag& bag) {
    require(bag.topics.size() == 3 && bag.topics[0].type == "geometry_msgs/msg/PoseArray" &&
                bag.topics[1].type == "trajectory_msgs/msg/MultiDOFJointTrajectory" &&
                bag.topics[2].type == "std_msgs/msg/Bool",
            "topics of poses, trajectory and arc");
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
        point.time_s = way.number<std::int32_t>();
        point.time_s += 1e-9 * way.number<std::uint32_t>();
        result.points.push_back(point);
    }
    way.end();
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
}

// What lengths and times say, where there is enough of both to tell.
void require_speed(const Point& from, const Point& to) {
    const double seconds = to.time_s - from.time_s, length = (to.pose.p - from.pose.p).norm();
    require(seconds > 0, "times that go on");
    if (seconds > 1e-5 && length > 1e-8) {
        require(std::abs(length / seconds / to.linear.norm() - 1) < 0.005, "velocities that lengths and times have");
    }
}

}  // namespace

std::vector<Target> read_ros(const std::vector<TextFile>& files) {
    require(files.size() == 3, "three files");
    const Messages yaml = from_yaml(files[0], files[1]);
    const Bag bag = read_mcap(files[2].text, files[2].name);
    require_same(yaml, from_bag(bag));
    std::vector<Target> targets;
    std::size_t event = 2;
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
    return targets;
}

}  // namespace seampath::exporting
