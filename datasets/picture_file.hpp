#pragma once

#include <string>

#include <Eigen/Geometry>
#include <nlohmann/json_fwd.hpp>

#include "stages/geometry/camera.hpp"
#include "stages/geometry/grey_image.hpp"

namespace seampath {

/// A grey PNG of 8 or 16 bits, as `white` says. Throws InternalError for a size that a PNG can't have.
std::string png_bytes(const GreyImage& image);

/// A camera and a pose as a capture file has them.
nlohmann::ordered_json camera_json(const CameraModel& camera);
nlohmann::ordered_json pose_json(const Eigen::Isometry3d& pose);

}  // namespace seampath
