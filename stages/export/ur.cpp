#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "stages/error.hpp"
#include "stages/export/text.hpp"
#include "stages/geometry/pose.hpp"

/// Universal Robots URScript: one function of moves in the base frame. Metres and rotation vectors in rad with 6
/// decimals, m/s with 6. Weld points are movep (constant tool speed) and movec, with blends that can't overlap; all
/// else is movel, and through the air movej where the arm is known.
namespace seampath::exporting {
namespace ur_writer {

constexpr std::size_t kMaxName = 64;
constexpr double kRounding_mm = 0.0005;
constexpr double kMaxCoordinate_mm = 10000;  // no robot of theirs reaches that far
constexpr double kMinSpeed_mm_s = 0.1;       // speeds have a micron a second

// URScript's own defaults, m/s^2.
constexpr double kAcceleration = 1.2;
constexpr double kAxisAcceleration = 1.4;  // rad/s^2

// The controller skips a move whose blend overlaps its neighbour's: a blend takes at most this share of the shorter
// neighbour, at most that much, and none below a hundredth of a millimetre.
constexpr double kBlendShare = 0.4;
constexpr double kMaxBlend_mm = 1;
constexpr double kMinBlend_mm = 0.01;

// Standard digital outputs are 0 to 7.
constexpr double kLastOutput = 7;

const std::vector<std::string_view>& reserved() {
    static const std::vector<std::string_view> words{"and",      "break",
                                                     "continue", "def",
                                                     "elif",     "else",
                                                     "end",      "false",
                                                     "for",      "global",
                                                     "halt",     "if",
                                                     "in",       "join",
                                                     "kill",     "local",
                                                     "not",      "or",
                                                     "pass",     "return",
                                                     "run",      "sec",
                                                     "struct",   "switch",
                                                     "thread",   "true",
                                                     "while",    "xor",
                                                     "movel",    "movep",
                                                     "movej",    "movec",
                                                     "set_tcp",  "sleep",
                                                     "p",        "stopl",
                                                     "stopj",    "set_standard_digital_out"};
    return words;
}

std::string pose(const Eigen::Vector3d& p_mm, const Eigen::Vector3d& rotation) {
    std::string text = "p[";
    for (int i = 0; i < 3; ++i) {
        text += fixed(p_mm[i] / 1000, 6) + ", ";
    }
    return text + fixed(rotation[0], 6) + ", " + fixed(rotation[1], 6) + ", " + fixed(rotation[2], 6) + "]";
}

double blend_mm(const Waypoint& before, const Waypoint& w, const Waypoint& after) {
    const double shorter = std::min((w.p - before.p).norm(), (after.p - w.p).norm());
    const double blend = std::min(kMaxBlend_mm, kBlendShare * shorter);
    return blend < kMinBlend_mm ? 0 : blend;
}

// Along the axes: v is the speed of the one that turns most, of which every axis must be capable.
std::string axes_move(const Target& target, const ArmTravel& arm, const ExportOptions& options) {
    const double slowest = *std::min_element(arm.max_speed.begin(), arm.max_speed.end());
    std::vector<std::string> q;
    for (const double rad : target.axes.back().q) {
        q.push_back(fixed(rad, 6));
    }
    return "  movej([" + joined(q, ", ") + "], a=" + plain(kAxisAcceleration) +
           ", v=" + fixed(slowest * options.joint_speed_percent / 100, 6) + ")\n";
}

std::string move(const std::vector<Target>& all, std::size_t k) {
    const Waypoint& w = all[k].at;
    const bool circular = all[k].move == Move::circular;
    const bool welding = w.kind == WaypointKind::weld || w.kind == WaypointKind::weld_end;
    std::string text = circular  ? "  movec(" + pose(all[k - 1].at.p, rotation_vector(all[k - 1].at.q)) + ", "
                       : welding ? "  movep("
                                 : "  movel(";
    text += pose(w.p, rotation_vector(w.q)) + ", a=" + plain(kAcceleration) + ", v=" + fixed(w.speed_mm_s / 1000, 6);
    if (w.kind == WaypointKind::weld) {
        text += ", r=" + fixed(blend_mm(all[k - 1].at, w, all[k + 1].at) / 1000, 6);
    }
    return text + (circular ? ", mode=0)\n" : ")\n");
}

std::string arc(const ExportOptions& options, bool on) {
    if (!options.ur_arc_output) {
        return {};
    }
    return "  set_standard_digital_out(" + plain(*options.ur_arc_output) + ", " + (on ? "True" : "False") + ")\n";
}

Told told(const ExportOptions& options) {
    return options.ur_arc_output ? Told::welding : Told::motion;
}

std::vector<std::string> problems(const ExportOptions& options) {
    std::vector<std::string> found =
        name_problems("program_name", options.program_name, kMaxName, reserved(), "URScript");
    if (options.ur_tcp.size() != 6 ||
        !std::all_of(options.ur_tcp.begin(), options.ur_tcp.end(), [](double v) { return std::isfinite(v); })) {
        found.push_back("ur_tcp: [" + list(options.ur_tcp, ", ") +
                        "] is no pose; x, y, z in mm and a rotation vector in rad were needed");
    }
    append(found, number_problems("ur_arc_output", options.ur_arc_output, 0, kLastOutput, "standard digital output"));
    return found;
}

std::vector<TextFile> write(const Program& program, const ExportOptions& options) {
    std::string text = "def " + options.program_name + "():\n";
    for (const std::string& line : preamble(program, options, kRounding_mm)) {
        text += "  # " + line + "\n";
    }
    text += "  # Units: m, rad, m/s; poses are position and rotation vector.\n";
    if (program.targets.front().axes.empty()) {
        text += "  # The first move is straight from where the robot stands.\n";
    }
    const auto& tcp = options.ur_tcp;
    text += "  set_tcp(" + pose({tcp[0], tcp[1], tcp[2]}, {tcp[3], tcp[4], tcp[5]}) + ")\n";
    if (options.ur_arc_output) {
        text += arc(options, false);
    }
    const auto& all = program.targets;
    for (std::size_t k = 0; k < all.size(); ++k) {
        const Waypoint& w = all[k].at;
        if (k == 0 || w.seam != all[k - 1].at.seam) {
            text += "  # seam " + std::to_string(w.seam) + "\n";
        }
        if (!all[k].axes.empty()) {
            text += axes_move(all[k], *program.plan.arm, options);
        } else if (all[k].move != Move::via) {
            text += move(all, k);
        }
        if (w.kind == WaypointKind::weld_start) {
            text += arc(options, true);
        } else if (w.kind == WaypointKind::weld_end) {
            text += arc(options, false);
        }
    }
    return {{options.program_name + ".script", text + "end\n"}};
}

}  // namespace ur_writer

constinit const Format kUr{
    "ur", ur_writer::kRounding_mm, ur_writer::kMaxCoordinate_mm, ur_writer::kMinSpeed_mm_s, false,  true, Axes::air,
    true, ur_writer::told,         ur_writer::problems,          ur_writer::write,          read_ur};

}  // namespace seampath::exporting
