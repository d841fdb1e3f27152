#pragma once

#include <span>
#include <string>

#include <Eigen/Core>

#include "stages/geometry/quadric.hpp"

/// Least-squares (Gaussian) associated features, as coordinate metrology defines them (ISO 14405-1, ISO 10360-6): the
/// sum of squared orthogonal distances is least, all points count the same. Double precision about the centroid, to
/// rounding. Each throws InputError, beginning with `who`, for points that do not determine the feature.
namespace seampath {

struct Line {
    Eigen::Vector3d point;
    Eigen::Vector3d direction;  ///< unit
};

/// A circle in space; distances are in space, not in the circle's plane.
struct Circle {
    Eigen::Vector3d centre;
    Eigen::Vector3d normal;  ///< unit
    double radius = 0;
};

/// A feature and how far the points are from it.
template <class S>
struct Associated {
    S shape;
    double rms = 0;      ///< mm, of the orthogonal distances
    double largest = 0;  ///< mm, by magnitude
};

/// At least 3 points; the normal's sign is so that its largest component is above 0. `point` is the centroid.
Associated<Plane> associated_plane(std::span<const Eigen::Vector3d> points, const std::string& who);

/// At least 2 points; sign of the direction as above. `point` is the centroid.
Associated<Line> associated_line(std::span<const Eigen::Vector3d> points, const std::string& who);

/// At least 3 points.
Associated<Circle> associated_circle(std::span<const Eigen::Vector3d> points, const std::string& who);

/// At least 4 points.
Associated<Sphere> associated_sphere(std::span<const Eigen::Vector3d> points, const std::string& who);

/// Of a known radius: its centre alone is asked. At least 3 points.
Associated<Sphere> associated_sphere(std::span<const Eigen::Vector3d> points, double radius, const std::string& who);

/// At least 5 points, with about where the axis points (within some 30 degrees). `point` is the axis's nearest to the
/// centroid.
Associated<Cylinder> associated_cylinder(std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& axis,
                                         const std::string& who);

}  // namespace seampath
