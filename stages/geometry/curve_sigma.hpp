#pragma once

#include <vector>

#include "stages/geometry/smoothing.hpp"

namespace seampath {

/// How well a smoothed curve is known at its knots and half way between them: the root of the mean square of noise and
/// bias, per direction across. Noise is (N + P)^-1 N (N + P)^-1, where N is the normal matrix of the points and P that
/// of the penalty. The bias, by which the penalty flattens bends, goes with lambda where it is small: it is told from
/// the curve that a smaller lambda gives of the same points (Richardson's extrapolation), (N + P)^-1 P of that curve,
/// and its own noise is left in, for what that curve is too stiff itself. Of the stated variances, `given` as
/// 1/sigma^2, what the points don't show is added: neighbours that share an error agree with each other.
///
/// `spline` is solved with `s.lambda` for points of the weights with which it was; `points` have parameters on it.
std::vector<CurveSigma> sigma_along(const PenalisedSpline& spline, const Smoothing& s, const CurvePoints& points,
                                    const std::vector<double>& given);

}  // namespace seampath
