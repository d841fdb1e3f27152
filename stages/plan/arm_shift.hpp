#pragma once

#include <optional>

#include "stages/plan/plan.hpp"

/// Private to the plan stage: where the part would have to lie for an arm to make its travel.
namespace seampath::planning {

/// The shortest move of the part, along the base's axes and the diagonals between them and up to 2 m, after which the
/// arm makes all ways of the plan, mm; found to a millimetre on thinned ways, and checked on the whole ones. Nothing
/// where no direction helps.
std::optional<Eigen::Vector3d> helpful_shift(const std::vector<Waypoint>& waypoints, const ArmCell& cell,
                                             const PlanOptions& options);

}  // namespace seampath::planning
