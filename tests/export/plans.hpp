#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "stages/export/export.hpp"
#include "stages/types.hpp"

/// Plans made by hand and by chance, for the exporters.
namespace seampath::test {

inline Waypoint waypoint(int seam, WaypointKind kind, double station_mm, const Eigen::Vector3d& p,
                         const Eigen::Quaterniond& q, double speed_mm_s) {
    Waypoint w;
    w.seam = seam;
    w.kind = kind;
    w.station_mm = station_mm;
    w.p = p;
    w.q = q;
    w.speed_mm_s = speed_mm_s;
    w.sigma_mm = 0.03125;
    return w;
}

/// Numbers the waypoints of each seam and times them along straight lines.
inline Plan finished(std::vector<Waypoint> waypoints) {
    for (std::size_t k = 1; k < waypoints.size(); ++k) {
        const Waypoint& from = waypoints[k - 1];
        waypoints[k].index = waypoints[k].seam == from.seam ? from.index + 1 : 0;
        waypoints[k].time_s = from.time_s + (waypoints[k].p - from.p).norm() / waypoints[k].speed_mm_s;
    }
    Plan plan;
    plan.waypoints = std::move(waypoints);
    plan.max_chord_error_mm = 0.015625;
    plan.duration_s = plan.waypoints.back().time_s;
    return plan;
}

/// Approach, two weld points 10 mm apart and retract, the torch always at q.
inline Plan plan_with(const Eigen::Quaterniond& q, double speed_mm_s = 8.5) {
    const Eigen::Vector3d x = q * Eigen::Vector3d::UnitX(), z = q * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d p(25.1234, 10.5678, -1.25);
    return finished({waypoint(0, WaypointKind::approach, 0, p - 30 * z, q, 100),
                     waypoint(0, WaypointKind::weld_start, 0, p, q, 100),
                     waypoint(0, WaypointKind::weld_end, 10, p + 10 * x, q, speed_mm_s),
                     waypoint(0, WaypointKind::retract, 10, p + 10 * x - 30 * z, q, 100)});
}

/// A straight seam at 8.5 mm/s and a closed one at 12 mm/s whose corners lie on a circle, with numbers that every
/// machine computes alike: quaternions of thirds, halves and fifths, and no function but the square root.
inline Plan golden_plan() {
    using enum WaypointKind;
    const Eigen::Quaterniond a(0, 1, 0, 0), b(0, 0.6, 0.8, 0), c(0.5, 0.5, 0.5, -0.5), d(-0.1, 0.7, 0.7, 0.1);
    return finished(
        {waypoint(0, approach, 0, {10.25, -4, 30}, a, 100), waypoint(0, weld_start, 0, {10.25, -4, 0}, a, 100),
         waypoint(0, weld, 40, {50.25, -4, 0.0625}, a, 8.5),
         waypoint(0, weld, 50.5, {60.75, -4.0078125, 0.0625}, b, 8.5),
         waypoint(0, weld_end, 90.5, {100.75, -4.0078125, 0}, b, 8.5),
         waypoint(0, retract, 90.5, {100.75, -4.0078125, 30}, b, 100), waypoint(1, air, 0, {60, 20, 60}, a, 250),
         waypoint(1, approach, 0, {50, 0, 25}, c, 250), waypoint(1, weld_start, 0, {50, 0, 0}, c, 100),
         waypoint(1, weld, 32.25, {30, 40, 0}, c, 12), waypoint(1, weld, 96.75, {-40, 30, 0}, d, 12),
         waypoint(1, weld, 150, {-30, -40, 0}, d, 12), waypoint(1, weld, 215, {40, -30, 0}, c, 12),
         waypoint(1, weld_end, 314, {50, 0, 0}, c, 12), waypoint(1, retract, 314, {50, 0, 25}, c, 100)});
}

/// The golden plan as that robot can have it: LinuxCNC's angles have no way from one of its orientations, tool X
/// straight down, to the next, and noether has welds only.
inline Plan golden_plan_for(std::string_view robot) {
    Plan plan = golden_plan();
    if (robot == "linuxcnc") {
        const auto turn = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::Ones(), Eigen::Vector3d::UnitZ());
        for (Waypoint& w : plan.waypoints) {
            w.q = (turn * w.q).normalized();
        }
    }
    return plan;
}

/// The golden plan with an arm, every angle a sixteenth of a rad, that is at each waypoint and once in between. Through
/// the air its axes take half as long again as the tool would.
inline Plan arm_plan() {
    Plan plan = golden_plan();
    ArmTravel arm;
    arm.arm = "Arm 6";
    arm.max_speed = {2, 2, 2.5, 4, 4, 5};
    double time_s = 0;
    for (std::size_t k = 0; k < plan.waypoints.size(); ++k) {
        const Waypoint& w = plan.waypoints[k];
        const bool in_air = w.kind == WaypointKind::air || w.kind == WaypointKind::approach;
        const double step_s = k == 0 ? 0 : (in_air ? 1.5 : 1) * (w.time_s - plan.waypoints[k - 1].time_s);
        for (const int half : {1, 2}) {
            if (half == 2 || step_s > 0) {
                ArmSample sample{w.seam, w.kind, half == 2 ? static_cast<int>(k) : -1, w.station_mm, 0, {}, 0, 0.1};
                const int turn = static_cast<int>(2 * k) + half - 2;
                sample.time_s = time_s + 0.5 * half * step_s;
                sample.q = {turn / 16.0, (turn - 8) / 16.0,   1.5 - turn / 16.0,
                            -0.25,       -1.25 + turn / 32.0, -turn / 16.0};
                arm.samples.push_back(sample);
            }
        }
        time_s += step_s;
    }
    plan.arm = arm;
    return plan;
}

/// Every robot but those named.
inline std::string robots_without(std::string_view left_out) {
    std::string robots;
    for (const std::string_view name : kRobotNames) {
        if (left_out.find(name) == std::string_view::npos) {
            robots += (robots.empty() ? "" : ",") + std::string(name);
        }
    }
    return robots;
}

/// The numbers of a cell that no robot can do without.
inline ExportOptions cell_options() {
    ExportOptions options;
    options.robots = robots_without("");
    options.kuka_tool = 6;
    options.fanuc_tool = 2;
    options.fanuc_user_frame = 1;
    options.fanuc_configuration = "N U T, 0, 0, 0";
    options.yaskawa_tool = 1;
    options.yaskawa_speed_unit = "cm/min";
    options.yaskawa_configuration = "1,0,0,0,0,0";
    options.yaskawa_pulses_per_deg = {1435.5, -1300.25, 1422, 1000, 1102.75, 640};
    options.arm_joints = "joint_1,joint_2,joint_3,joint_4,joint_5,joint_6";
    return options;
}

/// With all that the arc is switched on and off with.
inline ExportOptions arc_options() {
    ExportOptions options = cell_options();
    options.abb_seam_data = "seam1";
    options.abb_weld_data = "weld1";
    options.abb_weave_data = "weave1";
    options.kuka_base = 3;
    options.kuka_arc_on = "ArcOn";
    options.kuka_arc_off = "ArcOff";
    options.fanuc_arc_start = 6;
    options.fanuc_arc_end = 7;
    options.fanuc_weave = 8;
    options.ur_arc_output = 3;
    options.yaskawa_user_frame = 2;
    options.yaskawa_arc_start = 4;
    options.yaskawa_arc_end = 5;
    options.yaskawa_weave = 9;
    options.linuxcnc_tool = 2;
    options.linuxcnc_work_offset = 7;
    options.linuxcnc_arc_output = 1;
    return options;
}

/// Seams of as many weld points each, 20 mm apart, torch down; `at` gives the k-th point of a seam from its start, mm.
template <class At>
Plan side_by_side(int seams, int points, At&& at) {
    std::vector<Waypoint> waypoints;
    const Eigen::Quaterniond down(0, 1, 0, 0);
    const Eigen::Vector3d above(0, 0, 30);
    for (int seam = 0; seam < seams; ++seam) {
        const Eigen::Vector3d start(0, 20 * seam, 0);
        waypoints.push_back(waypoint(seam, WaypointKind::approach, 0, start + above, down, 100));
        for (int k = 0; k < points; ++k) {
            const auto kind = k == 0            ? WaypointKind::weld_start
                              : k == points - 1 ? WaypointKind::weld_end
                                                : WaypointKind::weld;
            waypoints.push_back(waypoint(seam, kind, k, start + at(k), down, 8));
        }
        const Eigen::Vector3d end = start + at(points);
        waypoints.push_back(waypoint(seam, WaypointKind::retract, points, end + above, down, 100));
    }
    return finished(waypoints);
}

inline double at_random(std::mt19937_64& generator, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator);
}

inline Eigen::Vector4d random_direction(std::mt19937_64& generator) {
    std::normal_distribution<double> normal;
    return Eigen::Vector4d(normal(generator), normal(generator), normal(generator), normal(generator)).normalized();
}

/// One to three seams of 2 to 40 weld points each, anywhere within 3 m, at any rotation, turned by less than half a
/// turn from point to point or not at all. Speeds are whole centimetres a minute, which every language can hold.
inline Plan random_plan(std::mt19937_64& generator) {
    const auto uniform = [&](double low, double high) { return at_random(generator, low, high); };
    const auto direction = [&] { return random_direction(generator); };
    std::vector<Waypoint> waypoints;
    const int seams = std::uniform_int_distribution<int>(1, 3)(generator);
    for (int seam = 0; seam < seams; ++seam) {
        const double speed = std::floor(uniform(12, 360)) / 6, air = std::floor(uniform(50, 900)),
                     step = std::pow(10, uniform(-2, 2));
        Eigen::Vector3d p(uniform(-3000, 3000), uniform(-3000, 3000), uniform(-3000, 3000));
        Eigen::Quaterniond q(direction());
        const auto add = [&](WaypointKind kind, double at, double how_fast) {
            waypoints.push_back(waypoint(seam, kind, at, p, q, how_fast));
        };
        if (seam > 0) {
            add(WaypointKind::air, 0, air);
        }
        add(WaypointKind::approach, 0, air);
        p += 30 * Eigen::Vector3d(direction().head<3>());
        add(WaypointKind::weld_start, 0, air);
        const int points = std::uniform_int_distribution<int>(2, 40)(generator);
        for (int k = 1; k < points; ++k) {
            p += step * Eigen::Vector3d(direction().head<3>());
            q = (q * Eigen::Quaterniond(Eigen::Vector4d(direction() * 0.05 + Eigen::Vector4d::UnitW()))).normalized();
            add(k == points - 1 ? WaypointKind::weld_end : WaypointKind::weld, step * k, speed);
        }
        p += 30 * Eigen::Vector3d(direction().head<3>());
        add(WaypointKind::retract, step * points, air);
    }
    return finished(waypoints);
}

/// A weld along a helix of any size, pitch and place, at 1 to 3 deg a waypoint and as many as 300 of them, with a torch
/// that keeps its place on it.
inline Plan random_helix(std::mt19937_64& generator) {
    const auto uniform = [&](double low, double high) { return at_random(generator, low, high); };
    const double radius = uniform(10, 300), rise = uniform(-0.05, 0.05) * radius, step = uniform(1, 3) / 180 * M_PI;
    const int points = static_cast<int>(uniform(20, 300));
    const Eigen::Quaterniond turn(random_direction(generator)), torch(random_direction(generator));
    const Eigen::Vector3d centre(uniform(-2000, 2000), uniform(-2000, 2000), uniform(-2000, 2000));
    std::vector<Waypoint> waypoints;
    for (int k = -1; k <= points; ++k) {
        const double angle = step * std::clamp(k, 0, points - 1), off = k < 0 || k == points ? 30 : 0;
        const Eigen::Quaterniond along(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
        const WaypointKind kind = k < 0             ? WaypointKind::approach
                                  : k == 0          ? WaypointKind::weld_start
                                  : k == points     ? WaypointKind::retract
                                  : k == points - 1 ? WaypointKind::weld_end
                                                    : WaypointKind::weld;
        waypoints.push_back(waypoint(0, kind, angle * radius,
                                     centre + turn * (along * Eigen::Vector3d(radius, 0, rise * angle + off)),
                                     turn * along * torch, k > 0 && k < points ? 9 : 100));
    }
    return finished(waypoints);
}

}  // namespace seampath::test
