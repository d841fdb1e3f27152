#include "stages/geometry/urdf.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <vector>

#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/geometry/xml.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kMmPerMetre = 1000;

// A chain longer than this goes round in circles.
constexpr std::size_t kMostJoints = 200;

struct Joint {
    std::string name, type, parent, child;
    Isometry3d origin = Isometry3d::Identity();  ///< mm
    Vector3d axis{1, 0, 0};
    std::optional<double> lower, upper, velocity;
    std::size_t line = 0;
};

class Reader {
public:
    Reader(std::string_view text, std::string file) : file_(std::move(file)), elements_(xml_elements(text, file_)) {
        if (elements_.front().name != "robot") {
            fail(elements_.front().line, "the first element is no <robot>; a URDF was needed");
        }
    }

    Arm arm() const {
        const std::vector<Joint> joints = read_joints();
        const std::vector<const Joint*> chain = chain_of(joints);
        Arm arm;
        arm.name = attribute(elements_.front(), "name", false);
        Isometry3d pose = Isometry3d::Identity();
        std::size_t axis = 0;
        for (const Joint* joint : chain) {
            pose = pose * joint->origin;
            if (joint->type != "fixed") {
                arm.axes.at(axis++) = axis_of(*joint, pose);
            }
        }
        arm.base_from_flange = pose;
        arm.kind = kind_of(arm);
        return arm;
    }

private:
    [[noreturn]] void fail(std::size_t line, const std::string& what) const {
        throw InputError("arm: " + file_ + ":" + std::to_string(line) + ": " + what);
    }

    std::string attribute(const XmlElement& e, const std::string& key, bool needed = true) const {
        const auto found = e.attributes.find(key);
        if (found == e.attributes.end() && needed) {
            fail(e.line, "<" + e.name + "> has no " + key + "; a URDF was needed in which it has one");
        }
        return found == e.attributes.end() ? "" : found->second;
    }

    std::vector<double> numbers(const XmlElement& e, const std::string& key, std::size_t count) const {
        const std::string text = attribute(e, key);
        std::vector<double> values;
        const char *at = text.data(), *end = at + text.size();
        while (at != end) {
            if (*at == ' ' || *at == '\t' || *at == '\n' || *at == '\r' || *at == '+') {
                ++at;
                continue;
            }
            double value = 0;
            const auto [next, error] = std::from_chars(at, end, value);
            if (error != std::errc() || !std::isfinite(value)) {
                break;
            }
            values.push_back(value);
            at = next;
        }
        if (at != end || values.size() != count) {
            const bool macro = text.find("${") != std::string::npos;
            fail(e.line, key + "=\"" + text + "\"; " + std::to_string(count) + (count == 1 ? " number" : " numbers") +
                             (macro ? " were needed; this is a xacro: run xacro on it first" : " were needed"));
        }
        return values;
    }

    double number(const XmlElement& e, const std::string& key) const { return numbers(e, key, 1)[0]; }

    std::vector<Joint> read_joints() const {
        std::vector<Joint> joints;
        for (std::size_t i = 0; i < elements_.size(); ++i) {
            if (elements_[i].depth == 1 && elements_[i].name == "joint") {
                joints.push_back(read_joint(i));
            }
        }
        return joints;
    }

    Joint read_joint(std::size_t first) const {
        const XmlElement& e = elements_[first];
        Joint joint{
            attribute(e, "name"), attribute(e, "type"), "", "", Isometry3d::Identity(), {1, 0, 0}, {}, {}, {}, e.line};
        for (std::size_t i = first + 1; i < elements_.size() && elements_[i].depth > e.depth; ++i) {
            const XmlElement& part = elements_[i];
            if (part.depth != e.depth + 1) {
                continue;
            }
            if (part.name == "origin") {
                joint.origin = origin_of(part);
            } else if (part.name == "axis") {
                const auto v = numbers(part, "xyz", 3);
                joint.axis = Vector3d(v[0], v[1], v[2]);
            } else if (part.name == "parent") {
                joint.parent = attribute(part, "link");
            } else if (part.name == "child") {
                joint.child = attribute(part, "link");
            } else if (part.name == "limit") {
                const auto given = [&](const char* key) {
                    return part.attributes.contains(key) ? std::optional(number(part, key)) : std::nullopt;
                };
                joint.lower = given("lower");
                joint.upper = given("upper");
                joint.velocity = given("velocity");
            }
        }
        if (joint.parent.empty() || joint.child.empty()) {
            fail(e.line, "joint \"" + joint.name + "\" has no parent or no child; both were needed");
        }
        return joint;
    }

    Isometry3d origin_of(const XmlElement& e) const {
        Isometry3d origin = Isometry3d::Identity();
        if (e.attributes.contains("xyz")) {
            const auto v = numbers(e, "xyz", 3);
            origin.translation() = kMmPerMetre * Vector3d(v[0], v[1], v[2]);
        }
        if (e.attributes.contains("rpy")) {
            const auto v = numbers(e, "rpy", 3);
            origin.linear() = (Eigen::AngleAxisd(v[2], Vector3d::UnitZ()) * Eigen::AngleAxisd(v[1], Vector3d::UnitY()) *
                               Eigen::AngleAxisd(v[0], Vector3d::UnitX()))
                                  .toRotationMatrix();
        }
        return origin;
    }

    /// Joints from the root to a link.
    std::vector<const Joint*> up_from(const std::string& link, const std::vector<Joint>& joints) const {
        std::vector<const Joint*> chain;
        std::string at = link;
        while (true) {
            const auto joint =
                std::find_if(joints.begin(), joints.end(), [&](const Joint& j) { return j.child == at; });
            if (joint == joints.end()) {
                break;
            }
            if (chain.size() == kMostJoints) {
                fail(joint->line, "joint \"" + joint->name + "\" is in a chain that comes back to itself");
            }
            chain.push_back(&*joint);
            at = joint->parent;
        }
        std::reverse(chain.begin(), chain.end());
        return chain;
    }

    std::vector<const Joint*> chain_of(const std::vector<Joint>& joints) const {
        const auto is_child = [&](const std::string& link) {
            return std::any_of(joints.begin(), joints.end(), [&](const Joint& j) { return j.child == link; });
        };
        std::vector<const Joint*> chain;
        for (const char* tip : {"tool0", "flange"}) {
            if (chain.empty() && is_child(tip)) {
                chain = up_from(tip, joints);
            }
        }
        if (chain.empty()) {
            for (const Joint& joint : joints) {
                const auto candidate = up_from(joint.child, joints);
                chain = candidate.size() > chain.size() ? candidate : chain;
            }
        }
        const auto moving = [](const Joint* j) { return j->type == "revolute" || j->type == "continuous"; };
        for (const Joint* joint : chain) {
            if (!moving(joint) && joint->type != "fixed") {
                fail(joint->line, "joint \"" + joint->name + "\" is " + joint->type +
                                      "; revolute, continuous and fixed ones were needed between base and flange");
            }
        }
        const auto axes = std::count_if(chain.begin(), chain.end(), moving);
        if (axes != kArmAxes) {
            throw InputError("arm: " + file_ + ": " + std::to_string(axes) +
                             " turning joints lie between base and flange; 6 were needed");
        }
        return chain;
    }

    ArmAxis axis_of(const Joint& joint, const Isometry3d& pose) const {
        const bool continuous = joint.type == "continuous";
        if (!(joint.axis.norm() > 0)) {
            fail(joint.line, "joint \"" + joint.name + "\" turns about no direction; an axis xyz was needed");
        }
        if (!joint.velocity || !(*joint.velocity > 0)) {
            fail(joint.line, "joint \"" + joint.name + "\" has no velocity above 0 in its limit; rad/s were needed");
        }
        if (!continuous && (!joint.lower || !joint.upper || !(*joint.lower < *joint.upper))) {
            fail(joint.line, "joint \"" + joint.name + "\" has no limits, lower below upper, rad; they were needed");
        }
        return {joint.name,
                pose.translation(),
                (pose.linear() * joint.axis).normalized(),
                continuous ? -kTurn : *joint.lower,
                continuous ? kTurn : *joint.upper,
                *joint.velocity};
    }

    std::string file_;
    std::vector<XmlElement> elements_;
};

}  // namespace

Arm arm_from_urdf(std::string_view text, const std::string& file) {
    return Reader(text, file).arm();
}

}  // namespace seampath
