#pragma once

#include <array>
#include <optional>

#include <Eigen/Core>
#include <Eigen/Geometry>

/// A camera's frame: x to the right of the picture, y down, z ahead. Pixels are as in grey_image.hpp.
namespace seampath {

/// A pinhole with the lens distortion of D. C. Brown, Decentering distortion of lenses, 1966: with x, y = X/Z, Y/Z and
/// r^2 = x^2 + y^2, the pixel lies at
///     x (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2),  the same with y and p1, p2 exchanged,
/// times the focal length, plus the centre.
struct CameraModel {
    int width = 0;  ///< px
    int height = 0;
    Eigen::Vector2d focal_px{0, 0};
    Eigen::Vector2d centre_px{0, 0};
    std::array<double, 5> distortion{};  ///< k1, k2, p1, p2, k3, in the order of OpenCV
};

/// Where a point before the camera is seen.
Eigen::Vector2d pixel_of(const CameraModel& camera, const Eigen::Vector3d& p_in_camera);

/// The direction of what is seen at a pixel, so long that its z is 1. Newton's method on the distortion; empty where
/// the lens model has no such direction, which happens far outside the picture that it was calibrated on.
std::optional<Eigen::Vector3d> direction_of(const CameraModel& camera, const Eigen::Vector2d& pixel);

/// Where what is seen at a pixel lies on the plane z = 0, plane's frame, mm. Throws InputError where the plane is not
/// before the camera there, or is seen at less than 5 degrees: a pixel is then a tenth of the distance.
Eigen::Vector3d point_on_plane(const CameraModel& camera, const Eigen::Isometry3d& camera_from_plane,
                               const Eigen::Vector2d& pixel);

/// Whether the camera stands on the side of the plane to which its z points.
bool is_seen_from_above(const Eigen::Isometry3d& camera_from_plane);

}  // namespace seampath
