#pragma once

#include <vector>

#include "stages/plan/torch.hpp"

/// Private to the plan stage: how far a seam is from a straight move.
namespace seampath::planning {

/// A seam at samples so close that what lies between two of them is known to within `bulge_mm`.
struct Samples {
    std::vector<TorchPose> pose;   ///< ascending in u, the whole seam
    std::vector<double> bulge_mm;  ///< [k]: bound of the curve's distance from the chord of samples k and k + 1
};

/// Samples for moves that stay within `tolerance_mm`: some 16 under each. The bound is |c''| du^2 / 8, with the largest
/// |c''| of the knot span, in which c'' is linear.
Samples sample(const TorchPath& path, double tolerance_mm);

/// The seam between two poses against the straight move between them.
struct Chord {
    double error_mm = 0;  ///< upper bound of the distance
    double turn = 0;      ///< largest rotation from or to an end, rad
};
Chord chord(const Samples& samples, const TorchPose& a, const TorchPose& b);

}  // namespace seampath::planning
