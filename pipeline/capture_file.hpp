#pragma once

#include <filesystem>
#include <variant>
#include <vector>

#include <Eigen/Geometry>

#include "stages/geometry/camera.hpp"
#include "stages/optics/optics.hpp"
#include "stages/stripe/stripe.hpp"

/// Capture files: JSON with comments that names pictures, says what is known of the camera that took them, and where it
/// stood. Every key is needed unless said otherwise, an unknown one is an error; paths are relative to the file.
///
///     { "kind": "laser_stripe",
///       "camera": { "size_px": [w, h], "matrix_px": [[fx, 0, cx], [0, fy, cy], [0, 0, 1]],
///                   "distortion": [k1, k2, p1, p2, k3] },                    (distortion: without it there is none)
///       "laser_plane": { "normal": [x, y, z], "distance_mm": d },            (n p = d, camera's frame)
///       "frames": [ { "image": "000.png", "base_from_camera": [x, y, z, qw, qx, qy, qz] }, ... ] }
///
///     { "kind": "depth", "camera": ..., "image": "depth.png", "mm_per_unit": 0.1,
///       "base_from_camera": [x, y, z, qw, qx, qy, qz] }                      (without it the camera is the base)
///
///     { "kind": "photo", "camera": ..., "image": "joint.jpg",                (PNG or JPEG)
///       "camera_from_plane": [x, y, z, qw, qx, qy, qz] }                     (the joint is on the plane's z = 0)
///
/// Instead of the pose a photograph may have four or more points of the plane, as they are read off the picture:
///
///       "plane_points": [ { "pixel_px": [x, y], "plane_mm": [x, y] }, ... ]  (pixels from the middle of the first)
namespace seampath {

/// A laser line in a sequence of pictures, all of one camera.
struct StripeCapture {
    CameraModel camera;
    LaserPlane plane;
    std::vector<std::filesystem::path> images;
    std::vector<Eigen::Isometry3d> base_from_camera;  ///< one an image
};

/// One picture whose grey values are depths along the camera's axis; 0 is no measurement.
struct DepthCapture {
    CameraModel camera;
    std::filesystem::path image;
    double mm_per_unit = 1;
    Eigen::Isometry3d base_from_camera = Eigen::Isometry3d::Identity();
};

/// A photograph of a flat joint.
struct PhotoCapture {
    CameraModel camera;
    std::filesystem::path image;
    Eigen::Isometry3d camera_from_plane = Eigen::Isometry3d::Identity();
    BoardView plane_points;  ///< instead of the pose, where there are any
};

using Capture = std::variant<StripeCapture, DepthCapture, PhotoCapture>;

/// All pictures that a capture names.
std::vector<std::filesystem::path> images_of(const Capture& capture);

/// Whether a file is taken for a capture: by its name, which ends in .json.
bool is_capture(const std::filesystem::path& file);

/// Throws one InputError with all that is wrong, a line each: "file: /camera/size_px: ...". The pictures are not
/// opened, but all of them are there.
Capture read_capture(const std::filesystem::path& file);

}  // namespace seampath
