#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "stages/export/text.hpp"

/// Reads a URScript function of moves: metres, rad and m/s, rotation vectors, defaults of the official manual, outputs
/// that a weld hangs on. Refuses what a controller would skip or refuse.
namespace seampath::exporting {
namespace ur_reader {

struct Value {
    std::vector<double> pose;  // of p[...], or empty
    std::vector<double> axes;  // of [...], or empty
    double number = 0;
    std::string word;  // True or False, or empty
};

struct Call {
    std::string name;
    std::vector<Value> positional;
    std::map<std::string, Value> named;
};

// Behind the opening bracket.
std::vector<double> six_numbers(Scanner& scan) {
    std::vector<double> numbers;
    do {
        numbers.push_back(scan.number());
    } while (scan.accept(','));
    scan.expect(']');
    if (numbers.size() != 6) {
        scan.fail("six numbers before this place");
    }
    return numbers;
}

Value value_after_name(Scanner& scan, const std::string& name) {
    Value result;
    if (name == "p") {
        scan.expect('[');
        result.pose = six_numbers(scan);
    } else if (name == "True" || name == "False") {
        result.word = name;
    } else {
        scan.fail("p[...], True or False before this place");
    }
    return result;
}

Value value(Scanner& scan) {
    if (scan.at_name()) {
        return value_after_name(scan, scan.name());
    }
    Value result;
    if (scan.accept('[')) {
        result.axes = six_numbers(scan);
    } else {
        result.number = scan.number();
    }
    return result;
}

Call call(Scanner& scan, std::string name) {
    Call result{std::move(name), {}, {}};
    scan.expect('(');
    for (bool more = !scan.accept(')'); more;) {
        if (scan.at_name()) {
            const std::string word = scan.name();
            if (scan.accept('=')) {
                result.named[word] = value(scan);
            } else {
                result.positional.push_back(value_after_name(scan, word));
            }
        } else {
            result.positional.push_back(value(scan));
        }
        more = scan.accept(',');
        if (!more) {
            scan.expect(')');
        }
    }
    return result;
}

// Angle times axis, by the definition of the rotation vector.
Eigen::Quaterniond rotation(double rx, double ry, double rz) {
    const Eigen::Vector3d vector(rx, ry, rz);
    const double angle = vector.norm();
    return angle > 0 ? Eigen::Quaterniond(Eigen::AngleAxisd(angle, vector / angle)) : Eigen::Quaterniond::Identity();
}

class Controller {
public:
    explicit Controller(const TextFile& file) : scan_(file, '#') {
        if (scan_.name() != "def") {
            scan_.fail("def before this place");
        }
        scan_.name();
        for (const char c : {'(', ')', ':'}) {
            scan_.expect(c);
        }
        for (std::string word = scan_.name(); word != "end"; word = scan_.name()) {
            execute(call(scan_, word));
        }
        require(scan_.done(), "the end of the file");
        require(!arc_, "the output off at the end");
        check_blends();
    }
    std::vector<Target> targets;

private:
    void require(bool holds, const std::string& needed) const {
        if (!holds) {
            scan_.fail(needed + " before this place");
        }
    }

    void execute(const Call& c) {
        if (c.name == "set_tcp") {
            require(c.positional.size() == 1 && c.positional[0].pose.size() == 6, "the pose of the tool");
            tcp_ = true;
        } else if (c.name == "set_standard_digital_out") {
            require(c.positional.size() == 2 && !c.positional[1].word.empty(), "the number of an output and its state");
            output(c.positional[1].word == "True");
        } else if (c.name == "movej") {
            axes_move(c);
        } else if (c.name == "movel" || c.name == "movep" || c.name == "movec") {
            move(c);
        } else {
            scan_.fail("a known function before this place");
        }
    }

    // The arc burns from the point reached when the output goes on to the one reached when it goes off.
    void output(bool on) {
        require(on != arc_ || !on, "the output off first");
        if (on || arc_) {
            require(!targets.empty() && blends_.back() == 0, "a standstill where the output changes");
            targets.back().at.kind = on ? WaypointKind::weld_start : WaypointKind::weld_end;
        }
        arc_ = on;
    }

    // movej(q, a=1.4, v=1.05, t=0, r=0), rad and rad/s.
    void axes_move(const Call& c) {
        require(tcp_ && !arc_, "set_tcp, and the output off,");
        require(c.positional.size() == 1 && c.positional[0].axes.size() == 6, "the angles of the axes");
        for (const auto& [name, given] : c.named) {
            require((name == "a" || name == "v") && given.number > 0, "only a and v, above 0,");
        }
        std::array<double, 6> q_deg{};
        for (std::size_t i = 0; i < q_deg.size(); ++i) {
            q_deg[i] = 180 / std::numbers::pi * c.positional[0].axes[i];
            require(std::abs(q_deg[i]) <= 363, "angles within the joints' limits");
        }
        targets.push_back(axes_target(q_deg));
        blends_.push_back(0);
    }

    // movel(pose, a=1.2, v=0.25, t=0, r=0), movep(pose, a=1.2, v=0.25, r=0), movec(via, to, a=1.2, v=0.25, r=0, mode=0)
    void move(const Call& c) {
        const bool circular = c.name == "movec";
        const std::size_t points = circular ? 2 : 1;
        require(tcp_, "set_tcp");
        require(c.positional.size() == points, std::to_string(points) + " poses");
        const auto named = [&](const char* name, double otherwise) {
            const auto found = c.named.find(name);
            return found == c.named.end() ? otherwise : found->second.number;
        };
        for (const auto& [name, given] : c.named) {
            require(name != "t", "no time, since it overrides the speed,");
            require(name == "a" || name == "v" || name == "r" || (circular && name == "mode" && given.number == 0),
                    "only a, v, r and, of a circle, mode=0");
        }
        require(!circular || !targets.empty(), "a point to start from");
        for (std::size_t k = 0; k < points; ++k) {
            const auto& pose = c.positional[k].pose;
            require(pose.size() == 6, "a pose");
            Target target;
            target.move = !circular ? Move::linear : k == 0 ? Move::via : Move::circular;
            target.at.kind = arc_ ? WaypointKind::weld : WaypointKind::air;
            target.at.p = 1000 * Eigen::Vector3d(pose[0], pose[1], pose[2]);
            target.at.q = rotation(pose[3], pose[4], pose[5]);
            target.at.speed_mm_s = 1000 * named("v", 0.25);
            targets.push_back(target);
            blends_.push_back(k + 1 < points ? 0 : 1000 * named("r", 0));
            targets.back().passed = blends_.back() > 0;
        }
    }

    // A blend must stay below half of both neighbouring moves, or it may overlap the next and the move is skipped.
    void check_blends() const {
        for (std::size_t k = 0; k < targets.size(); ++k) {
            if (blends_[k] == 0) {
                continue;
            }
            require(k > 0 && k + 1 < targets.size() &&
                        2 * blends_[k] < (targets[k].at.p - targets[k - 1].at.p).norm() &&
                        2 * blends_[k] < (targets[k + 1].at.p - targets[k].at.p).norm(),
                    "blends below half of both neighbouring moves (move " + std::to_string(k) + ")");
        }
    }

    Scanner scan_;
    std::vector<double> blends_;  // mm, one a target
    bool tcp_ = false;
    bool arc_ = false;
};

}  // namespace ur_reader

std::vector<Target> read_ur(const std::vector<TextFile>& files) {
    return ur_reader::Controller(files.at(0)).targets;
}

}  // namespace seampath::exporting
