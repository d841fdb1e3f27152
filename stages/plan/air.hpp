#pragma once

#include <optional>
#include <vector>

#include "stages/plan/clearance.hpp"
#include "stages/types.hpp"

/// Private to the plan stage: the ways to a seam, from it, and from one to the next. Where a clearance is given they
/// are free of the scan.
namespace seampath::planning {

/// The pose that stands `back_mm` behind w along the torch; where the torch would touch the scan on the way there, in
/// the direction least turned from that in which it does not, up to 60 deg. Nothing where there is none.
std::optional<Waypoint> backed_off(const Waypoint& w, WaypointKind kind, double back_mm, double speed_mm_s,
                                   const Clearance* clearance);

/// The point over which the torch goes from `retract` to `approach` where the straight move would come nearer to a seam
/// than both ends and `clearance_mm` are, or would touch the scan: above the middle, away from the joints, as high as
/// that takes, turned half way. `seams` are the weld waypoints of every seam, in order. Where no height up to 32
/// clearances is enough it is the highest.
std::optional<Waypoint> air_point(const Waypoint& retract, const Waypoint& approach,
                                  const std::vector<std::vector<Waypoint>>& seams, double clearance_mm,
                                  const Clearance* clearance);

}  // namespace seampath::planning
