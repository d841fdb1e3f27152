#pragma once

#include "stages/geometry/surface_fit.hpp"
#include "stages/types.hpp"

/// Fitted surfaces as the plain values that a seam carries (types.hpp), and back.
namespace seampath {

/// `covariance` is that of the fit's parameters, or one that knows of more than the fit; `explains` is left to the
/// caller.
FlankSurface flank_surface(const SurfaceFit& fit, const Eigen::MatrixXd& covariance);

/// In a frame in which `origin` is 0. Throws InputError when the covariance has not the size that the shape needs.
SurfaceFit surface_fit(const FlankSurface& surface, const Eigen::Vector3d& origin);

/// A matrix row by row, and back.
std::vector<double> rows_of(const Eigen::MatrixXd& matrix);
Eigen::MatrixXd matrix_of(const std::vector<double>& rows, Eigen::Index height, Eigen::Index width);

}  // namespace seampath
