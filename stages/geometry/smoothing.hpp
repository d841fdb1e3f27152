#pragma once

#include <vector>

#include "stages/geometry/pspline.hpp"

/// How stiff a penalised spline may be, chosen from the points alone. The third derivative is taken as random, of
/// variance noise / lambda, and lambda as that which makes the points most likely (REML, by MacKay's fixed point 1992:
/// the roughness found is that which the freedom left to it explains). Likelihood finds where a curve bends, yet leaves
/// too free what is smoother than any random curve; the common level of stiffness is therefore set by the risk (Mallows
/// 1973).
namespace seampath {

struct Smoothing {
    std::vector<double> lambda;  ///< per span of the spline
    double misfit = 0;           ///< sum of weight times squared distance
    double freedom = 0;          ///< effective number of coefficients per axis: trace of the hat matrix
    double noise = 0;            ///< variance of distance times root of weight
};

/// The most likely lambda that is the same everywhere, from the lambdas given, which should be too small rather than
/// too large: a curve that is too free sees everything, one too stiff takes bends for noise.
void smooth_evenly(PenalisedSpline& spline, const CurvePoints& points, Smoothing& smoothing);

/// The most likely lambdas, each over a window as wide as the curve needs to have some freedom in it: straights become
/// stiff and bends stay free.
void smooth_locally(PenalisedSpline& spline, const CurvePoints& points, Smoothing& smoothing);

/// Multiplies all lambdas by that one number that makes the risk least. Returns the risk.
double set_level(PenalisedSpline& spline, const CurvePoints& points, Smoothing& smoothing);

}  // namespace seampath
