#pragma once

#include <vector>

#include "stages/plan/plan.hpp"
#include "stages/types.hpp"

/// Private to the plan stage: which parts of a seam are welded, from where and in which direction.
namespace seampath::planning {

/// A part of a seam as a seam of its own.
struct Stretch {
    SeamModel model;
    double before_mm = 0;  ///< of the way before it
};

/// The whole way of the torch along a seam: in the direction of plan.backwards; a closed one from
/// plan.start_station_mm round and over its start by plan.overlap_mm; an open one with its ends moved by
/// plan.extend_start_mm and plan.extend_end_mm. Points and arc length are those of the seam, to rounding. Throws
/// InputError for a start beyond the seam's end, an overlap longer than the seam, and when nothing is left of it.
SeamModel whole_way(const SeamModel& model, int seam, const PlanOptions& options);

/// What plan.pattern welds of a way: all of it; stitches of plan.stitch_length_mm with gaps next to plan.stitch_gap_mm,
/// n = round((L + gap) / (length + gap)) of them so that both ends are welded; plan.tacks tacks of
/// plan.tack_length_mm, the first and the last at the ends, or in the middle where it is one; round a closed seam as
/// many gaps as pieces. Throws InputError for pieces that don't fit.
std::vector<Stretch> stretches(const SeamModel& way, int seam, const PlanOptions& options);

}  // namespace seampath::planning
