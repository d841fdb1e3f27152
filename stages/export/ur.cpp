#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "stages/error.hpp"
#include "stages/export/text.hpp"
#include "stages/geometry/pose.hpp"

/// Universal Robots URScript: one function of moves in the base frame. Metres and rotation vectors in rad with 6
/// decimals, m/s with 6. Weld points are movep (constant tool speed) with blends that can't overlap; all else is movel.
namespace seampath::exporting {
namespace {

constexpr std::size_t kMaxName = 64;

// URScript's own default, m/s^2.
constexpr double kAcceleration = 1.2;

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

std::string move(const std::vector<Waypoint>& all, std::size_t k) {
    const Waypoint& w = all[k];
    const bool welding = w.kind == WaypointKind::weld || w.kind == WaypointKind::weld_end;
    std::string text = std::string("  ") + (welding ? "movep(" : "movel(") + pose(w.p, rotation_vector(w.q)) +
                       ", a=" + plain(kAcceleration) + ", v=" + fixed(w.speed_mm_s / 1000, 6);
    if (w.kind == WaypointKind::weld) {
        text += ", r=" + fixed(blend_mm(all[k - 1], w, all[k + 1]) / 1000, 6);
    }
    return text + ")\n";
}

std::string arc(const ExportOptions& options, bool on) {
    if (!options.ur_arc_output) {
        return {};
    }
    return "  set_standard_digital_out(" + plain(*options.ur_arc_output) + ", " + (on ? "True" : "False") + ")\n";
}

}  // namespace

Told ur_told(const ExportOptions& options) {
    return options.ur_arc_output ? Told::welding : Told::motion;
}

std::vector<std::string> ur_problems(const ExportOptions& options) {
    std::vector<std::string> problems =
        name_problems("program_name", options.program_name, kMaxName, reserved(), "URScript");
    if (options.ur_tcp.size() != 6 ||
        !std::all_of(options.ur_tcp.begin(), options.ur_tcp.end(), [](double v) { return std::isfinite(v); })) {
        problems.push_back("ur_tcp: [" + list(options.ur_tcp, ", ") +
                           "] is no pose; x, y, z in mm and a rotation vector in rad were needed");
    }
    const auto& output = options.ur_arc_output;
    if (output && !(*output >= 0 && *output <= kLastOutput && *output == std::floor(*output))) {
        problems.push_back("ur_arc_output: " + plain(*output) +
                           " is no standard digital output; a whole number from 0 to 7 was needed");
    }
    return problems;
}

std::vector<TextFile> write_ur(const Plan& in_base, const ExportOptions& options) {
    std::string text = "def " + options.program_name + "():\n";
    for (const std::string& line : preamble(in_base, options, kUrRounding_mm)) {
        text += "  # " + line + "\n";
    }
    text += "  # Units: m, rad, m/s; poses are position and rotation vector.\n";
    text += "  # The first move is straight from where the robot stands.\n";
    const auto& tcp = options.ur_tcp;
    text += "  set_tcp(" + pose({tcp[0], tcp[1], tcp[2]}, {tcp[3], tcp[4], tcp[5]}) + ")\n";
    if (options.ur_arc_output) {
        text += arc(options, false);
    }
    const auto& all = in_base.waypoints;
    for (std::size_t k = 0; k < all.size(); ++k) {
        if (k == 0 || all[k].seam != all[k - 1].seam) {
            text += "  # seam " + std::to_string(all[k].seam) + "\n";
        }
        text += move(all, k);
        if (all[k].kind == WaypointKind::weld_start) {
            text += arc(options, true);
        } else if (all[k].kind == WaypointKind::weld_end) {
            text += arc(options, false);
        }
    }
    return {{options.program_name + ".script", text + "end\n"}};
}

}  // namespace seampath::exporting
