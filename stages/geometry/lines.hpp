#pragma once

#include <Eigen/Geometry>

namespace seampath {

/// How far along each of two lines, from p along s and from q along t, they come nearest to each other, mm. Both
/// directions are unit and not parallel.
struct LinesMeet {
    double along_s, along_t;
    Eigen::Vector3d middle;  ///< between both places
};
inline LinesMeet nearest_of_lines(const Eigen::Vector3d& p, const Eigen::Vector3d& s, const Eigen::Vector3d& q,
                                  const Eigen::Vector3d& t) {
    const Eigen::Vector3d apart = q - p, n = s.cross(t);
    const double along_s = apart.cross(t).dot(n) / n.squaredNorm(), along_t = apart.cross(s).dot(n) / n.squaredNorm();
    return {along_s, along_t, 0.5 * (p + along_s * s + q + along_t * t)};
}

}  // namespace seampath
