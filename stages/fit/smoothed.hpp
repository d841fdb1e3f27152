#pragma once

#include "stages/fit/pspline.hpp"

namespace seampath {

/// The smoothing spline of fit.hpp. Gives each of the points the parameter of the curve's point nearest to it, and the
/// weight with which it counts at last: 0 for single points that are off from their neighbours.
FittedCurve smooth_points(CurvePoints& points, bool closed);

}  // namespace seampath
