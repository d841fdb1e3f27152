#pragma once

#include "stages/fit/fit.hpp"
#include "stages/geometry/pspline.hpp"

namespace seampath {

/// How far a polynomial of higher degree may be from the cubics that stand for it, mm.
inline constexpr double kPolynomialTolerance_mm = 1e-6;

/// The interpolating models of fit.hpp. Gives each of the points the parameter of the curve's point nearest to it.
FittedCurve interpolate_nodes(CurvePoints& points, const Nodes& nodes, bool closed, const FitOptions& options);

}  // namespace seampath
