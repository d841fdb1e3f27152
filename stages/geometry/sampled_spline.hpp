#pragma once

#include <functional>

#include "stages/types.hpp"

namespace seampath {

/// A curve that stands for another one, and how far it was found to be from it between its knots.
struct SampledSpline {
    CubicBSpline curve;
    double rms_mm = 0;
    double max_mm = 0;
};

/// The cubic spline through points of a smooth curve, which is given by its arc length (or something near it), from 0
/// to `length`: periodic, or with ends that are not a knot. Spans are halved until all of them are within `tolerance`
/// (mm), or within rounding, of the curve at three places in between.
SampledSpline spline_through(const std::function<Eigen::Vector3d(double)>& at, double length, bool closed,
                             double tolerance);

}  // namespace seampath
