#pragma once

#include <vector>

#include <Eigen/Geometry>

namespace seampath {

/// A pose as options hold it: x, y, z in mm and a quaternion qw, qx, qy, qz of about length 1.
Eigen::Isometry3d pose_of(const std::vector<double>& option);

}  // namespace seampath
