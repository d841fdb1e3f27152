#pragma once

#include "stages/plan/plan.hpp"

/// Private to the plan stage: how an arm makes a planned travel.
namespace seampath::planning {

/// Sets plan.arm, and turns the waypoints about the wire as the arm needs it. Each way from an approach to its retract
/// is one track (arm_track.hpp) at the planned times; between two of them the arm goes by its joints (arm_air.hpp).
/// Where it can't, the waypoints stay as they are and the verdict says where, why, and by how little the part would
/// have to move: the shortest found in 26 directions. `plan` has waypoints.
void add_arm(Plan& plan, const ArmCell& cell, const PlanOptions& options);

}  // namespace seampath::planning
