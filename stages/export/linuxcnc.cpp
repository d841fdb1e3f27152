#include <algorithm>
#include <cmath>
#include <string>

#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/export/text.hpp"
#include "stages/geometry/pose.hpp"

/// G-code for LinuxCNC with a serial arm: X, Y, Z in mm with 4 decimals, A, B, C of Rz(C) Ry(B) Rx(A) in deg with 5, F
/// in mm/min, which is the speed of X, Y, Z. The controller moves A, B, C evenly, each by itself: they never jump by a
/// turn, and a move on which that is not the even rotation from pose to pose is divided. Air in exact path mode, welds
/// with G64. All moves are G1: G2 and G3 know the planes of the axes only.
namespace seampath::exporting {
namespace linuxcnc_writer {

constexpr std::size_t kMaxName = 64;
constexpr double kRounding_mm = 0.00005;
constexpr double kMaxCoordinate_mm = 99999;
constexpr double kMinSpeed_mm_s = 0.01;  // F has 4 decimals of a mm/min

// What the rotation of a move may differ from the even one.
constexpr double kMaxUneven = 0.0075 * kDegree;
constexpr int kMaxHalvings = 9;

// Angles z, y, x of the same rotation that are nearest to `before`: by whole turns, and by the other solution, which
// has y beyond a quarter turn.
Eigen::Vector3d nearest_angles(const Eigen::Quaterniond& q, const Eigen::Vector3d& before) {
    const Eigen::Vector3d one = euler_zyx(q, before[0]);
    const Eigen::Vector3d other(one[0] + kTurn / 2, kTurn / 2 - one[1], one[2] + kTurn / 2);
    const auto near = [&](const Eigen::Vector3d& zyx) {
        const Eigen::Vector3d away = zyx - before;
        return Eigen::Vector3d(before + (away.array() - kTurn * (away / kTurn).array().round()).matrix());
    };
    const Eigen::Vector3d a = near(one), b = near(other);
    return (b - before).norm() < (a - before).norm() - 1e-9 ? b : a;
}

// Largest angle between the even rotation and what the controller makes of it, at quarters of the way.
double unevenness(const Eigen::Quaterniond& from, const Eigen::Vector3d& from_zyx, const Eigen::Quaterniond& to) {
    const Eigen::Vector3d to_zyx = nearest_angles(to, from_zyx);
    double worst = 0;
    for (const double t : {0.25, 0.5, 0.75}) {
        const Eigen::Vector3d zyx = from_zyx + t * (to_zyx - from_zyx);
        worst = std::max(worst, rotation_angle(from.slerp(t, to), from_euler_zyx(zyx[0], zyx[1], zyx[2])));
    }
    return worst;
}

// Divides moves until each turns evenly.
class Divider {
public:
    std::vector<Target> divided;

    void go_to(const Target& target) {
        if (divided.empty()) {
            zyx_ = euler_zyx(target.at.q);
            divided.push_back(target);
        } else {
            halve(target, 0);
        }
    }

private:
    void halve(const Target& target, int halvings) {
        const Waypoint from = divided.back().at;
        if (unevenness(from.q, zyx_, target.at.q) > kMaxUneven) {
            if (halvings == kMaxHalvings) {
                throw InputError("export: linuxcnc: on the way to " + place(target.at) +
                                 " the torch passes so near to X straight up or down that A and C would whirl; another "
                                 "orientation is needed; change export.base_from_scan");
            }
            Target middle = target;
            middle.at.p = 0.5 * (from.p + target.at.p);
            middle.at.q = from.q.slerp(0.5, target.at.q);
            const bool weld = target.at.kind == WaypointKind::weld || target.at.kind == WaypointKind::weld_end;
            middle.at.kind = weld ? WaypointKind::weld : WaypointKind::air;
            halve(middle, halvings + 1);
            halve(target, halvings + 1);
            return;
        }
        zyx_ = nearest_angles(target.at.q, zyx_);
        divided.push_back(target);
    }

    Eigen::Vector3d zyx_;
};

// NOLINTNEXTLINE(performance-unnecessary-value-param): as Format::prepare has it
std::vector<Target> prepare(std::vector<Target> targets) {
    Divider divider;
    for (const Target& target : targets) {
        divider.go_to(target);
    }
    return divider.divided;
}

std::string without_zeros(std::string text) {
    text.erase(text.find_last_not_of('0') + 1);
    return text.back() == '.' ? text.substr(0, text.size() - 1) : text;
}

Told told(const ExportOptions& options) {
    return options.linuxcnc_arc_output ? Told::welding : Told::motion;
}

std::vector<std::string> problems(const ExportOptions& options) {
    std::vector<std::string> found = name_problems("program_name", options.program_name, kMaxName, {}, "LinuxCNC");
    append(found, number_problems("linuxcnc_tool", options.linuxcnc_tool, 1, 99999, "number of a tool"));
    append(found, number_problems("linuxcnc_work_offset", options.linuxcnc_work_offset, 1, 9, "work offset"));
    append(found, number_problems("linuxcnc_arc_output", options.linuxcnc_arc_output, 0, 63, "digital output"));
    return found;
}

// G54 to G59, then G59.1 to G59.3.
std::string work_offset(double n) {
    return n <= 6 ? "G" + plain(53 + n) : "G59." + plain(n - 6);
}

std::string head(const Program& program, const ExportOptions& options) {
    std::string text;
    for (const std::string& line : preamble(program, options, kRounding_mm)) {
        text += "; " + line + "\n";
    }
    text += "; Units: mm, deg, mm/min; A, B, C about X, Y, Z.\nG21 G90 G94 G17 G40 G80\n";
    text += options.linuxcnc_work_offset ? work_offset(*options.linuxcnc_work_offset) + "\n" : "";
    return text + (options.linuxcnc_tool ? "T" + plain(*options.linuxcnc_tool) + " M6\nG43\n" : "");
}

std::vector<TextFile> write(const Program& program, const ExportOptions& options) {
    const std::string blend = "G64 P" + plain(options.linuxcnc_tolerance_mm) + "\n";
    const auto arc = [&](const char* code) {
        return options.linuxcnc_arc_output ? code + plain(*options.linuxcnc_arc_output) + "\n" : std::string();
    };
    std::string text = head(program, options) + "G61\n";
    Eigen::Vector3d zyx = euler_zyx(program.targets.front().at.q);
    double speed = 0;
    bool blending = false;
    for (const Target& target : program.targets) {
        const Waypoint& w = target.at;
        // A move ends as the mode in which it begins says: the last of a weld is to end where it ought to.
        if (const bool wanted = w.kind == WaypointKind::weld; wanted != blending) {
            text += wanted ? blend : "G61\n";
            blending = wanted;
        }
        zyx = nearest_angles(w.q, zyx);
        text += "G1 X" + fixed(w.p.x(), 4) + " Y" + fixed(w.p.y(), 4) + " Z" + fixed(w.p.z(), 4) + " A" +
                fixed(zyx[2] / kDegree, 5) + " B" + fixed(zyx[1] / kDegree, 5) + " C" + fixed(zyx[0] / kDegree, 5);
        text += w.speed_mm_s != speed ? " F" + without_zeros(fixed(60 * w.speed_mm_s, 4)) + "\n" : "\n";
        speed = w.speed_mm_s;
        // Switched with the beginning of the next move.
        text += w.kind == WaypointKind::weld_start ? arc("M62 P")
                : w.kind == WaypointKind::weld_end ? arc("M63 P")
                                                   : "";
    }
    return {{options.program_name + ".ngc", text + "M2\n"}};
}

}  // namespace linuxcnc_writer

constinit const Format kLinuxcnc{"linuxcnc",
                                 linuxcnc_writer::kRounding_mm,
                                 linuxcnc_writer::kMaxCoordinate_mm,
                                 linuxcnc_writer::kMinSpeed_mm_s,
                                 false,
                                 false,
                                 Axes::none,
                                 true,
                                 linuxcnc_writer::told,
                                 linuxcnc_writer::problems,
                                 linuxcnc_writer::write,
                                 read_linuxcnc,
                                 linuxcnc_writer::prepare};

}  // namespace seampath::exporting
