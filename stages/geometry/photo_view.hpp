#pragma once

#include <Eigen/Geometry>

#include "stages/geometry/camera.hpp"
#include "stages/geometry/grey_image.hpp"
#include "stages/geometry/rigid.hpp"

namespace seampath {

/// A photograph of a plane. Positions on it are in the plane's frame, where it is z = 0, mm.
struct PhotoView {
    GreyImage image;
    CameraModel camera;
    Eigen::Isometry3d camera_from_plane = Eigen::Isometry3d::Identity();
    Matrix6 covariance = Matrix6::Zero();  ///< of camera_from_plane, as in stages/geometry/rigid.hpp, about its shift
};

}  // namespace seampath
