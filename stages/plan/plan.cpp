#include "stages/plan/plan.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/geometry/pose.hpp"
#include "stages/plan/air.hpp"
#include "stages/plan/arm_travel.hpp"
#include "stages/plan/order.hpp"
#include "stages/plan/weld.hpp"

namespace seampath {
namespace {

using namespace planning;

// Between the travel angles that are tried for an arm.
constexpr double kTravelStep_deg = 5;

// Index in the seam, quaternion sign and time, each from the waypoint before. Along a weld, with its lead-in and
// lead-out, the time between two of them stays as it was planned, elsewhere it is that of the straight move; a torch
// that turns on the spot takes none.
void number_and_time(std::vector<Waypoint>& waypoints) {
    if (waypoints.front().q.w() < 0) {
        waypoints.front().q.coeffs() *= -1;
    }
    waypoints.front().index = 0;
    double planned = std::exchange(waypoints.front().time_s, 0);
    for (std::size_t k = 1; k < waypoints.size(); ++k) {
        const Waypoint& from = waypoints[k - 1];
        Waypoint& to = waypoints[k];
        const double before = std::exchange(planned, to.time_s);
        to.index = to.seam == from.seam ? from.index + 1 : 0;
        to.q = nearest_sign(to.q, from.q);
        to.time_s = from.time_s + (planned > before ? planned - before : (to.p - from.p).norm() / to.speed_mm_s);
    }
}

bool welds(const Waypoint& w) {
    return w.kind == WaypointKind::weld_start || w.kind == WaypointKind::weld || w.kind == WaypointKind::weld_end;
}

// All welds with the ways between them.
void join(const std::vector<std::vector<Waypoint>>& all, const PlanOptions& options, const Clearance* clearance,
          Plan& result) {
    std::vector<std::vector<Waypoint>> seams;
    for (const auto& weld : all) {
        std::copy_if(weld.begin(), weld.end(), std::back_inserter(seams.emplace_back()), welds);
    }
    const double room = std::min(options.approach_mm, options.retract_mm);
    for (const auto& weld : all) {
        if (!result.waypoints.empty()) {
            if (auto air = air_point(result.waypoints.back(), weld.front(), seams, room, clearance)) {
                result.waypoints.push_back(std::move(*air));
            }
        }
        result.waypoints.insert(result.waypoints.end(), weld.begin(), weld.end());
    }
}

template <class T>
void append(std::vector<T>& to, std::vector<T>&& more) {
    to.insert(to.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

void add(SeamWelds&& seam, std::vector<std::vector<Waypoint>>& all, Plan& result) {
    result.max_chord_error_mm = std::max(result.max_chord_error_mm, seam.max_chord_error_mm);
    result.max_speed_error = std::max(result.max_speed_error, seam.max_speed_error);
    append(result.passes, std::move(seam.passes));
    append(result.travel, std::move(seam.travel));
    append(all, std::move(seam.welds));
    if (seam.refused) {
        result.refused.push_back(std::move(*seam.refused));
    }
}

void measure_turns(Plan& plan) {
    plan.max_turn_deg = 0;
    for (std::size_t k = 1; k < plan.waypoints.size(); ++k) {
        const Waypoint &from = plan.waypoints[k - 1], &to = plan.waypoints[k];
        if (to.kind == WaypointKind::weld || to.kind == WaypointKind::weld_end) {
            plan.max_turn_deg = std::max(plan.max_turn_deg, rotation_angle(from.q, to.q) * kDegreesPerRadian);
        }
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
    measure_turns(plan);
}

Plan plan_once(std::span<const SeamModel> models, const PlanOptions& options, const std::optional<ArmCell>& cell,
               const Clearance* clearance) {
    Plan result;
    std::vector<std::vector<Waypoint>> all;
    for (const Visit& visit : visits(models, options)) {
        SeamWelds seam = welds_of(models[static_cast<std::size_t>(visit.seam)], visit.seam, visit.options, clearance);
        add(std::move(seam), all, result);
    }
    join(all, options, clearance, result);
    if (result.waypoints.empty()) {
        return result;
    }
    number_and_time(result.waypoints);
    result.duration_s = result.waypoints.back().time_s;
    measure_turns(result);
    if (cell) {
        add_arm(result, *cell, options);
        measure_again(result);
    }
    return result;
}

PlanOptions with_travel_angle(PlanOptions options, double more_deg) {
    options.travel_angle_deg += more_deg;
    for (std::size_t i = 2; i < options.angle_table.size(); i += 3) {
        options.angle_table[i] += more_deg;
    }
    return options;
}

}  // namespace

Plan plan(std::span<const SeamModel> models, const PlanOptions& options, const std::optional<ArmCell>& cell,
          const Scan* scan) {
    ensure(options.speed_mm_s > 0 && options.air_speed_mm_s > 0 && options.approach_mm > 0 && options.retract_mm > 0 &&
               options.chord_tolerance_mm > 0 && options.max_turn_deg > 0,
           "plan options are within their bounds");
    std::optional<Clearance> room;
    if (scan != nullptr && !scan->points.empty() && options.nozzle_tip_mm && !models.empty()) {
        room.emplace(*scan, models, options);
    }
    const Clearance* clearance = room ? &*room : nullptr;
    Plan result = plan_once(models, options, cell, clearance);
    for (double more = kTravelStep_deg; result.arm && more <= options.arm_travel_angle_deg; more += kTravelStep_deg) {
        for (const double change : {more, -more}) {
            if (!result.arm->pass) {
                Plan other = plan_once(models, with_travel_angle(options, change), cell, clearance);
                if (other.arm && other.arm->pass) {
                    result = std::move(other);
                }
            }
        }
    }
    return result;
}

}  // namespace seampath
