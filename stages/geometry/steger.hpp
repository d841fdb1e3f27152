#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "stages/geometry/grey_image.hpp"

/// The ridge of a bright line at one place of a picture: C. Steger, An unbiased detector of curvilinear structures,
/// IEEE PAMI 20(2), 1998, section 3: derivatives with Gaussians, the direction n across the line from the Hessian, and
/// the middle at t n, t = -(r_x n_x + r_y n_y) / (r_xx n_x^2 + 2 r_xy n_x n_y + r_yy n_y^2).
namespace seampath {

/// A Gaussian and its derivatives at whole pixels from -radius to radius.
struct RidgeKernel {
    double sigma = 1;
    int radius = 0;
    std::vector<double> g, g1, g2;
};

RidgeKernel make_kernel(double sigma);

/// Slope of the ground beside the line, e.g. of an arc's glow, which is taken off the picture's.
struct GroundSlope {
    Eigen::Vector2d normal{0, 1};  ///< unit, across the line
    double slope = 0;              ///< grey values a px along it
};

struct RidgePoint {
    Eigen::Vector2d p;       ///< px
    Eigen::Vector2d normal;  ///< unit, across the line, downwards
    double sigma_px = 0;     ///< 1-sigma of p along the normal, from the picture's noise
};

/// The point of the ridge nearest to a pixel of the column, begun at a row; empty where there is none, or where it
/// stands steeper than 65 degrees. `noise`: 1-sigma of a pixel.
std::optional<RidgePoint> ridge_point(const GreyImage& image, const RidgeKernel& kernel, int column, double y,
                                      const GroundSlope& ground, double noise);

}  // namespace seampath
