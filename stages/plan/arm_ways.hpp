#pragma once

#include <utility>
#include <variant>
#include <vector>

#include "stages/plan/arm_track.hpp"

/// Private to the plan stage: the ways of a plan that the arm makes at the planned speed.
namespace seampath::planning {

/// Indices of each approach and its retract, the outer ones where there are leads.
std::vector<std::pair<std::size_t, std::size_t>> ways_of(const std::vector<Waypoint>& waypoints);

TrackOptions track_options(const Arm& arm, const PlanOptions& options);

}  // namespace seampath::planning
