#pragma once

#include <optional>
#include <vector>

#include "stages/types.hpp"

/// Private to the plan stage: the way from one seam to the next.
namespace seampath::planning {

/// The point over which the torch goes from `retract` to `approach` where the straight move would come nearer to a seam
/// than both ends and `clearance_mm` are: above the middle, away from the joints, as high as that takes, turned half
/// way. `seams` are the weld waypoints of every seam, in order. Knows nothing of the part but its seams.
std::optional<Waypoint> air_point(const Waypoint& retract, const Waypoint& approach,
                                  const std::vector<std::vector<Waypoint>>& seams, double clearance_mm);

}  // namespace seampath::planning
