#include "stages/plan/plan.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "stages/error.hpp"
#include "stages/geometry/pose.hpp"
#include "stages/plan/air.hpp"
#include "stages/plan/arm_travel.hpp"
#include "stages/plan/passes.hpp"
#include "stages/plan/stations.hpp"
#include "stages/plan/text.hpp"
#include "stages/plan/torch.hpp"

namespace seampath {
namespace {

using namespace planning;

Waypoint waypoint(const TorchPath& path, const TorchPose& pose, WaypointKind kind, double speed_mm_s) {
    Waypoint w;
    w.seam = path.seam();
    w.kind = kind;
    w.station_mm = pose.station_mm;
    w.p = pose.p;
    w.q = pose.q;
    w.speed_mm_s = speed_mm_s;
    w.sigma_mm = pose.sigma_mm;
    return w;
}

std::vector<Waypoint> weld_waypoints(const TorchPath& path, const std::vector<TorchPose>& poses,
                                     const PlanOptions& options) {
    std::vector<Waypoint> weld;
    for (const TorchPose& pose : poses) {
        weld.push_back(waypoint(path, pose, WaypointKind::weld, options.speed_mm_s));
    }
    weld.front().kind = WaypointKind::weld_start;
    weld.front().speed_mm_s = options.air_speed_mm_s;
    weld.back().kind = WaypointKind::weld_end;
    if (path.model().closed) {
        weld.back().p = weld.front().p;
        weld.back().q = weld.front().q;
    }
    return weld;
}

// The pose that stands `back_mm` behind w along the torch.
Waypoint backed_off(Waypoint w, WaypointKind kind, double back_mm, double speed_mm_s) {
    w.kind = kind;
    w.p -= back_mm * (w.q * Eigen::Vector3d::UnitZ());
    w.speed_mm_s = speed_mm_s;
    return w;
}

void measure(Plan& plan, const std::vector<Waypoint>& weld) {
    for (std::size_t k = 0; k + 1 < weld.size(); ++k) {
        const double arc = weld[k + 1].station_mm - weld[k].station_mm;
        const double chord = (weld[k + 1].p - weld[k].p).norm();
        plan.max_speed_error = std::max(plan.max_speed_error, std::abs(1 - chord / arc));
        plan.max_turn_deg =
            std::max(plan.max_turn_deg, rotation_angle(weld[k].q, weld[k + 1].q) * 180 / std::numbers::pi);
    }
}

// Index in the seam, quaternion sign and time, each from the waypoint before. Along the weld the way is that along the
// curve, elsewhere the straight move; a torch that turns on the spot takes no time.
void number_and_time(std::vector<Waypoint>& waypoints) {
    if (waypoints.front().q.w() < 0) {
        waypoints.front().q.coeffs() *= -1;
    }
    waypoints.front().index = 0;
    waypoints.front().time_s = 0;
    for (std::size_t k = 1; k < waypoints.size(); ++k) {
        const Waypoint& from = waypoints[k - 1];
        Waypoint& to = waypoints[k];
        const bool welding = to.kind == WaypointKind::weld || to.kind == WaypointKind::weld_end;
        const double way = welding ? to.station_mm - from.station_mm : (to.p - from.p).norm();
        to.index = to.seam == from.seam ? from.index + 1 : 0;
        to.q = nearest_sign(to.q, from.q);
        to.time_s = from.time_s + way / to.speed_mm_s;
    }
}

// One weld, or one a pass.
void add_welds(const SeamModel& model, int seam, const PlanOptions& options, std::vector<std::vector<Waypoint>>& welds,
               Plan& result) {
    const auto add = [&](const SeamModel& m) {
        const TorchPath path(m, seam, options);
        const WeldPoses weld = weld_poses(path, options);
        welds.push_back(weld_waypoints(path, weld.poses, options));
        result.max_chord_error_mm = std::max(result.max_chord_error_mm, weld.max_chord_error_mm);
        measure(result, welds.back());
    };
    if (options.groove == GrooveForm::none) {
        add(model);
        return;
    }
    for (const Pass& pass : passes_of(model, seam, options)) {
        add(pass.model);
        result.passes.push_back(pass.facts);
    }
}

// All welds with the ways between them.
void join(const std::vector<std::vector<Waypoint>>& welds, const PlanOptions& options, Plan& result) {
    for (const auto& weld : welds) {
        const Waypoint approach =
            backed_off(weld.front(), WaypointKind::approach, options.approach_mm, options.air_speed_mm_s);
        if (!result.waypoints.empty()) {
            const double clearance = std::min(options.approach_mm, options.retract_mm);
            if (auto air = air_point(result.waypoints.back(), approach, welds, clearance)) {
                result.waypoints.push_back(std::move(*air));
            }
        }
        result.waypoints.push_back(approach);
        result.waypoints.insert(result.waypoints.end(), weld.begin(), weld.end());
        result.waypoints.push_back(
            backed_off(weld.back(), WaypointKind::retract, options.retract_mm, options.air_speed_mm_s));
    }
    if (!result.waypoints.empty()) {
        number_and_time(result.waypoints);
        result.duration_s = result.waypoints.back().time_s;
    }
}

// After the torch was turned about its wire. An arm that makes the travel passes the waypoints in its own time.
void measure_again(Plan& plan) {
    number_and_time(plan.waypoints);
    for (const ArmSample& s : plan.arm->samples) {
        if (s.waypoint >= 0) {
            plan.waypoints[static_cast<std::size_t>(s.waypoint)].time_s = s.time_s;
        }
    }
    plan.duration_s = plan.waypoints.back().time_s;
    plan.max_turn_deg = 0;
    for (std::size_t k = 1; k < plan.waypoints.size(); ++k) {
        const Waypoint &from = plan.waypoints[k - 1], &to = plan.waypoints[k];
        if (to.kind == WaypointKind::weld || to.kind == WaypointKind::weld_end) {
            plan.max_turn_deg = std::max(plan.max_turn_deg, rotation_angle(from.q, to.q) * 180 / std::numbers::pi);
        }
    }
}

}  // namespace

Fields describe(PlanOptions& o) {
    return {
        {"speed_mm_s", &o.speed_mm_s, "travel speed along the seam, mm/s", within(0.1, 1000)},
        {"approach_mm", &o.approach_mm, "distance of the approach point before the weld, back along the torch, mm",
         within(1, 1000)},
        {"retract_mm", &o.retract_mm, "distance of the retract point after the weld, back along the torch, mm",
         within(1, 1000)},
        {"air_speed_mm_s", &o.air_speed_mm_s, "speed of all moves without arc, mm/s", within(1, 5000)},
        {"chord_tolerance_mm", &o.chord_tolerance_mm, "largest distance of straight moves from the seam curve, mm",
         within(0.001, 5)},
        {"max_turn_deg", &o.max_turn_deg, "largest turn of the torch between neighbouring waypoints, deg",
         within(0.1, 45)},
        {"work_angle_deg", &o.work_angle_deg,
         "turn of the torch about the direction of travel, deg; above 0 its body leans towards flank 1",
         within(-60, 60)},
        {"travel_angle_deg", &o.travel_angle_deg,
         "turn of the torch about the cross direction, deg; above 0 it points ahead (push), below 0 back (drag)",
         within(-60, 60)},
        {"groove", choice(o.groove, kGrooveFormNames),
         "section that passes fill: none is one pass; fillet lies between the flanks, v about their bisector, bevel1 "
         "between flank 2 and a bevel on the side of flank 1, bevel2 the other way round"},
        {"groove_depth_mm", &o.groove_depth_mm, "height of the fill above the root, along the groove's middle, mm",
         within(0.5, 200)},
        {"groove_root_mm", &o.groove_root_mm, "width of the groove at its root, mm", within(0, 50)},
        {"groove_angle_deg", &o.groove_angle_deg, "angle between the sides of a v, bevel1 or bevel2, deg",
         within(4, 160)},
        {"bead_area_mm2", &o.bead_area_mm2, "section of one bead, mm2: wire feed times wire section over speed",
         within(0.5, 1000)},
        {"bead_width_to_height", &o.bead_width_to_height, "width of a bead over its height", within(0.5, 8)},
        {"pass_order", choice(o.pass_order, kPassOrderNames), "side from which the beads of a layer are welded"},
        {"pass_tilt_deg", &o.pass_tilt_deg, "lean of the torch away from a groove's side at the beads beside it, deg",
         within(0, 45)},
        {"arm", &o.arm,
         "robot arm that makes the travel: abb-irb-1600-6-1.2, abb-irb-1600-8-1.45, ur10e, kuka-kr-16-2, fanuc-m-10ia, "
         "or a URDF file; empty: none. It stands where export.base_from_scan says"},
        {"flange_from_tool",
         &o.flange_from_tool,
         "pose of the torch's tip in the arm's flange: x, y, z mm, qw, qx, qy, qz",
         {},
         7},
        {"arm_roll_deg", &o.arm_roll_deg, "most that the arm may turn the torch about its wire, either way, deg",
         within(0, 180)},
        {"arm_acceleration_deg_s2", &o.arm_acceleration_deg_s2, "acceleration limits of the arm's axes, deg/s2",
         above(0), 6},
        {"fixture", &o.fixture,
         "result.json of a fixture calibration: the program moves to where it says that the part stands, in place of "
         "export.base_from_scan, and its uncertainty joins that of the waypoints; empty: none"},
        {"fixture_max_age_h", &o.fixture_max_age_h, "oldest calibration that is taken, hours; none: any", above(0)},
    };
}

std::vector<std::string> plan_problems(const PlanOptions& options) {
    const auto& pose = options.flange_from_tool;
    double norm = 0;
    bool finite = pose.size() == 7;
    for (std::size_t i = 0; finite && i < pose.size(); ++i) {
        finite = std::isfinite(pose[i]);
        norm = i >= 3 ? std::hypot(norm, pose[i]) : 0;
    }
    if (finite && std::abs(norm - 1) <= 1e-6) {
        return {};
    }
    return {"flange_from_tool: the quaternion qw, qx, qy, qz has a length of " + number(norm) +
            "; x, y, z in mm and a quaternion of length 1 were needed"};
}

Plan plan(std::span<const SeamModel> models, const PlanOptions& options, const std::optional<ArmCell>& cell) {
    ensure(options.speed_mm_s > 0 && options.air_speed_mm_s > 0 && options.approach_mm > 0 && options.retract_mm > 0 &&
               options.chord_tolerance_mm > 0 && options.max_turn_deg > 0,
           "plan options are within their bounds");
    Plan result;
    std::vector<std::vector<Waypoint>> welds;
    for (std::size_t i = 0; i < models.size(); ++i) {
        add_welds(models[i], static_cast<int>(i), options, welds, result);
    }
    join(welds, options, result);
    if (cell && !result.waypoints.empty()) {
        add_arm(result, *cell, options);
        measure_again(result);
    }
    return result;
}

}  // namespace seampath
