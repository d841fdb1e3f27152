#pragma once

#include "stages/geometry/pspline.hpp"

namespace seampath {

/// Mean of the seam's points. Rounding of coordinates about it hangs on the seam's size, not on where it lies.
Eigen::Vector3d middle_of(const Seam& seam);

/// The seam's points in the frame in which `middle` is 0, with weights 1/sigma^2; `u` is 0.
CurvePoints points_about(const Seam& seam, const Eigen::Vector3d& middle);

/// A penalised least-squares spline through the points (pspline.hpp), as stiff as they ask for (smoothing.hpp), by
/// orthogonal distances, with knots as dense as the freedom that it turns out to have. Gives each of the points the
/// parameter of the curve's point nearest to it, and the weight with which it counts at last: 0 for single points that
/// are off from their neighbours.
FittedCurve smooth_points(CurvePoints& points, bool closed);

}  // namespace seampath
