#pragma once

#include <vector>

#include <Eigen/Core>

namespace seampath {

/// Fréchet distance of two open polylines of at least two points each: the shortest leash on which a man and a dog can
/// walk them from end to end without going back (Alt & Godau, Computing the Fréchet distance between two polygonal
/// curves, 1995). By bisection on their free-space diagram, to 1e-4 of the distance or 1e-6; time is the product of
/// both numbers of points.
double frechet_distance(const std::vector<Eigen::Vector3d>& p, const std::vector<Eigen::Vector3d>& q);

}  // namespace seampath
