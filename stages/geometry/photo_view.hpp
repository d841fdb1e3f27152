#pragma once

#include <Eigen/Geometry>

#include "stages/geometry/camera.hpp"
#include "stages/geometry/grey_image.hpp"

namespace seampath {

/// A photograph of a plane. Positions on it are in the plane's frame, where it is z = 0, mm.
struct PhotoView {
    GreyImage image;
    CameraModel camera;
    Eigen::Isometry3d camera_from_plane = Eigen::Isometry3d::Identity();
};

}  // namespace seampath
