#pragma once

#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

/// Moves of a robot between two points: straight, or on a circle through a third. mm, rad.
namespace seampath {

/// Where a path lies nearest to a point.
struct NearestOnPath {
    double distance_mm = 0;
    double fraction = 0;  ///< of the path's length from its start, 0..1
};

NearestOnPath nearest_on_segment(const Eigen::Vector3d& p, const Eigen::Vector3d& start, const Eigen::Vector3d& end);

/// centre + radius * (cos t * x + sin t * y) for t = 0..angle; x, y unit and at right angles.
struct CircularArc {
    Eigen::Vector3d centre, x, y;
    double radius = 0;
    double angle = 0;  ///< above 0, below 2 pi

    Eigen::Vector3d at(double fraction) const;
};

/// From start through via to end; nothing where two of them coincide or all lie on one line to rounding.
std::optional<CircularArc> arc_through(const Eigen::Vector3d& start, const Eigen::Vector3d& via,
                                       const Eigen::Vector3d& end);

NearestOnPath nearest_on_arc(const Eigen::Vector3d& p, const CircularArc& arc);

}  // namespace seampath
