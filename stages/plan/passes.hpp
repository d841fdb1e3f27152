#pragma once

#include <vector>

#include "stages/plan/plan.hpp"
#include "stages/types.hpp"

/// Private to the plan stage: the passes that fill a groove.
namespace seampath::planning {

/// One pass as a seam of its own, and what it fills.
struct Pass {
    SeamModel model;
    PlannedPass facts;
};

/// Layers and beads that fill the section of plan.groove along a seam, from the root up.
///
/// The section is a trapezium about the groove's middle: root width b, half opening phi, height h; A(y) = b y + y^2 tan
/// phi lies below height y. A bead of area a and width over height w is t = sqrt(a / w) high. From the root on, a layer
/// takes as many beads as a groove of its middle width is beads wide, max(1, round(width / (w t))), and is as high as
/// those beads fill, until less than half a layer is left; the last layer takes as many as fill all that is left. All
/// beads then get the same share of the whole area; counts are those of the mean section, shares hold at every station,
/// so that passes stay beside each other where the groove opens and closes along the seam. A pass aims at the middle of
/// its bead's foot on the layer below, and leans away from the nearer side, most at the sides: by plan.pass_tilt_deg
/// or, in a narrower groove, along the other side. Throws InputError naming seam and station for flanks without a
/// bisector, an opening that has no such section, a pass that folds back where the seam bends to its side, and for more
/// than 500 passes.
std::vector<Pass> passes_of(const SeamModel& model, int seam, const PlanOptions& options);

}  // namespace seampath::planning
