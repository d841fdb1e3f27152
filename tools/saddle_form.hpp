#pragma once

#include <vector>

#include "stages/geometry/saddle.hpp"
#include "stages/types.hpp"

namespace seampath {

/// How far a closed seam, whose walls are out of round, is off the saddle of its own dimensions: at each branch angle,
/// rad, the part square to travel, mm, in the saddle's frame. The seam is laid on the saddle by the rigid motion of
/// least distances from it. A saddle with symmetries has several that are as good; the first of them is taken.
std::vector<Eigen::Vector3d> form_differences(const CubicBSpline& seam, const SaddleCurve& saddle,
                                              const std::vector<double>& thetas);

}  // namespace seampath
