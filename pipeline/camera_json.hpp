#pragma once

#include <Eigen/Geometry>

#include "pipeline/json_object.hpp"
#include "stages/geometry/camera.hpp"
#include "stages/stripe/stripe.hpp"

/// Poses, cameras and laser planes as they stand in the files of a user: see pipeline/capture_file.hpp. What is wrong
/// is complained of, and the value is then a default.
namespace seampath {

/// x, y, z, mm, and the quaternion w, x, y, z.
Eigen::Isometry3d pose_from(const JsonObject& object, const char* key);
JsonObject::Json pose_numbers(const Eigen::Isometry3d& pose);

CameraModel camera_from(const JsonObject::Json& value, const std::string& place, std::vector<std::string>& problems);
JsonObject::Json camera_json(const CameraModel& camera);

LaserPlane plane_from(const JsonObject::Json& value, const std::string& place, std::vector<std::string>& problems);
JsonObject::Json plane_json(const LaserPlane& plane);

}  // namespace seampath
