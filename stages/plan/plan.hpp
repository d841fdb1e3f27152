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
/// constant tool speed by inversion of the arc length, approach before and retract after each seam.
Plan plan(std::span<const SeamModel> models, const PlanOptions& options);

}  // namespace seampath
