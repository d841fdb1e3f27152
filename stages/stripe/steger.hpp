#pragma once

#include <optional>
#include <vector>

#include "stages/stripe/stripe.hpp"

/// Steger's ridge detector at one place; see stripe.hpp.
namespace seampath {

/// A Gaussian and its derivatives at whole pixels from -radius to radius.
struct RidgeKernel {
    double sigma = 1;
    int radius = 0;
    std::vector<double> g, g1, g2;
};

RidgeKernel make_kernel(double sigma);

/// Slope of the ground beside the stripe, e.g. of an arc's glow, which is taken off the picture's.
struct GroundSlope {
    Eigen::Vector2d normal{0, 1};  ///< unit, across the stripe
    double slope = 0;              ///< grey values a px along it
};

/// The point of the ridge nearest to a pixel of the column, begun at a row; empty where there is none. Its width is
/// left at 0.
std::optional<StripePoint> ridge_point(const GreyImage& image, const RidgeKernel& kernel, int column, double y,
                                       const GroundSlope& ground, double noise);

}  // namespace seampath
