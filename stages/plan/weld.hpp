#pragma once

#include <optional>
#include <vector>

#include "stages/plan/clearance.hpp"
#include "stages/plan/plan.hpp"
#include "stages/types.hpp"

/// Private to the plan stage: the welds of one seam.
namespace seampath::planning {

/// Each from its approach to its retract, in the order of welding; times count from each weld's own beginning. And how
/// good they are, as in Plan.
struct SeamWelds {
    std::vector<std::vector<Waypoint>> welds;
    std::vector<TravelSample> travel;
    std::vector<PlannedPass> passes;
    double max_chord_error_mm = 0;
    double max_speed_error = 0;
    std::optional<SeamRefusal> refused;
};

/// The way of the torch along a seam (stretch.hpp), in the passes that fill its groove (passes.hpp), each in the pieces
/// of plan.pattern: on each the torch is held clear of the scan (aside.hpp), gets its speed (speed.hpp) and waypoints
/// (stations.hpp), the wire swings (weave.hpp), the lead-in comes before and the lead-out behind, and before the arc
/// ends the torch goes back by plan.crater_back_mm. Throws InputError as those do, and for a weld that is shorter than
/// its lead-in and lead-out or its way back.
SeamWelds welds_of(const SeamModel& model, int seam, const PlanOptions& options, const Clearance* clearance);

}  // namespace seampath::planning
