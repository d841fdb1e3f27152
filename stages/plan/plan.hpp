#pragma once

#include <span>

#include "stages/options.hpp"
#include "stages/types.hpp"

namespace seampath {

struct PlanOptions {
    double speed_mm_s = 8;
    double approach_mm = 30;
    double retract_mm = 30;
    double air_speed_mm_s = 100;
    double chord_tolerance_mm = 0.02;
    double max_turn_deg = 3;
    double work_angle_deg = 0;
    double travel_angle_deg = 0;
};
Fields describe(PlanOptions&);

/// Torch poses along all models in the given order: +Z into the joint on the bisector of the flanks, +X along travel,
/// constant tool speed by inversion of the arc length, approach before and retract after each seam, and a point in the
/// air between two seams where the straight way would come near one. A closed seam ends in its first pose. Times are
/// those of the commanded speeds; turning on the spot takes none. Throws InputError naming seam and station where the
/// flanks have no bisector or the torch direction jumps, and for a seam shorter than ten chord tolerances.
Plan plan(std::span<const SeamModel> models, const PlanOptions& options);

}  // namespace seampath
