#include <algorithm>
#include <cmath>
#include <string>

#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/export/format.hpp"
#include "stages/export/text.hpp"
#include "stages/geometry/path_moves.hpp"

namespace seampath::exporting {
namespace {

// What half a unit of the last place at the ends of an arc can move its middle by: the arc turns by 5 deg at least, so
// that its sagitta is some 90 times smaller than its chord, and three points of it are rounded.
constexpr double kRoundings = 8;

// Behind waypoint `from`, the last one that may be passed without a stop or a change of speed.
std::size_t end_of_run(const std::vector<Waypoint>& all, std::size_t from) {
    std::size_t end = from + 1;
    while (end + 1 < all.size() && all[end].kind == WaypointKind::weld && all[end + 1].seam == all[from].seam &&
           all[end + 1].speed_mm_s == all[end].speed_mm_s &&
           (all[end + 1].kind == WaypointKind::weld || all[end + 1].kind == WaypointKind::weld_end)) {
        ++end;
    }
    return end;
}

std::vector<PathPose> poses_of(const std::vector<Waypoint>& all, std::size_t first, std::size_t last) {
    std::vector<PathPose> poses;
    for (std::size_t k = first; k <= last; ++k) {
        poses.push_back({all[k].p, all[k].q});
    }
    return poses;
}

// Straight and circular moves along welds, straight ones elsewhere.
std::vector<Target> fewest_targets(const std::vector<Waypoint>& all, const MoveTolerance& tolerance) {
    std::vector<Target> targets{{all.front(), Move::linear, 0}};
    for (std::size_t from = 0; from + 1 < all.size();) {
        const bool weld = all[from + 1].kind == WaypointKind::weld;
        const std::size_t end = weld ? end_of_run(all, from) : from + 1;
        for (const PathMove& move : fewest_moves(poses_of(all, from, end), tolerance)) {
            if (move.via) {
                targets.push_back({all[from + *move.via], Move::via, from + *move.via});
            }
            targets.push_back({all[from + move.end], move.via ? Move::circular : Move::linear, from + move.end});
        }
        from = end;
    }
    return targets;
}

}  // namespace

Program program_of(const Plan& in_base, const Format& format, const ExportOptions& options) {
    Program program{in_base, {}, in_base.max_chord_error_mm};
    const std::vector<Waypoint>& all = in_base.waypoints;
    if (format.arcs && options.arc_moves) {
        program.targets = fewest_targets(all, {options.arc_tolerance_mm, options.arc_tolerance_deg * kDegree});
        if (program.targets.size() < all.size()) {
            program.deviation_mm = std::max(program.deviation_mm, options.arc_tolerance_mm);
        }
    } else {
        for (std::size_t k = 0; k < all.size(); ++k) {
            program.targets.push_back({all[k], Move::linear, k});
        }
    }
    if (format.joint_start) {
        program.targets.front().move = Move::joint;
    }
    if (format.prepare != nullptr) {
        program.targets = format.prepare(std::move(program.targets));
    }
    add_axes(program, format, options);
    return program;
}

PathCheck check_path(const Program& program, const Format& format, const std::vector<Target>& read,
                     const ExportOptions& options) {
    PathCheck worst;
    const std::vector<Target>& written = program.targets;
    for (std::size_t k = 1; k < written.size(); ++k) {
        if (written[k].move == Move::via) {
            continue;
        }
        const std::size_t start = written[k].move == Move::circular ? k - 2 : k - 1;
        const std::size_t first = written[start].waypoint, last = written[k].waypoint;
        const bool weld = written[k].at.kind == WaypointKind::weld || written[k].at.kind == WaypointKind::weld_end;
        if (last <= first + 1 || !weld) {
            continue;
        }
        // The move as it was read, past the waypoints as they were planned.
        std::vector<PathPose> poses = poses_of(program.plan.waypoints, first, last);
        poses.front() = {read[start].at.p, read[start].at.q};
        poses.back() = {read[k].at.p, read[k].at.q};
        PathMove move{last - first, {}};
        if (written[k].move == Move::circular) {
            move.via = written[k - 1].waypoint - first;
            poses[*move.via].p = read[k - 1].at.p;
        }
        const MoveError error = move_error(poses, 0, move);
        const double slack_mm = kRoundings * format.position_rounding_mm, slack_deg = 2 * kMaxOrientationError_deg;
        if (!(error.distance_mm <= options.arc_tolerance_mm + slack_mm + 1e-9 &&
              error.angle_rad / kDegree <= options.arc_tolerance_deg + slack_deg)) {
            throw InternalError("export: " + std::string(format.name) + ": the move to " + place(written[k].at) +
                                " leaves the waypoints by " + plain(error.distance_mm) + " mm or " +
                                plain(error.angle_rad / kDegree) + " deg");
        }
        worst.max_error_mm = std::max(worst.max_error_mm, error.distance_mm);
        worst.max_turn_deg = std::max(worst.max_turn_deg, error.angle_rad / kDegree);
    }
    return worst;
}

}  // namespace seampath::exporting
