#pragma once

#include <optional>

#include <Eigen/Core>

#include "stages/geometry/grid.hpp"
#include "stages/geometry/scale.hpp"

namespace seampath {

/// How high the wall of normal n2 stands over the surface of normal n1, mm, by the middle of the points behind it: the
/// top of a lapped plate. p lies in its foot. Empty when there is nothing behind it.
std::optional<double> step_height(const PointGrid& grid, const ScanScale& scale, const Eigen::Vector3d& p,
                                  const Eigen::Vector3d& n1, const Eigen::Vector3d& n2);

}  // namespace seampath
