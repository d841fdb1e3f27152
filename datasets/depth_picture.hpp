#pragma once

#include <cstdint>
#include <filesystem>

#include <Eigen/Geometry>

#include "datasets/scenes.hpp"
#include "stages/geometry/camera.hpp"
#include "stages/geometry/grey_image.hpp"

/// Depth images of made parts.
namespace seampath {

/// What spoils a depth image.
struct DepthNoise {
    double sigma_mm = 0.05;  ///< of a depth, at working_distance_mm; it grows with the depth's square
    double working_distance_mm = 500;
    double mixed_pixels = 0.35;  ///< share of pixels at a depth step that fall between its two sides
    double dropout = 0.01;       ///< share of pixels without a depth
    double mm_per_unit = 0.01;   ///< of the image's grey values
};

/// Depths along the camera's axis of the scene's surfaces at the pixels' rays, as a 16-bit image; 0 where there is
/// none. The same for any number of threads. Depths must be below 65535 units.
GreyImage make_depth_picture(const Scene& scene, const CameraModel& camera, const Eigen::Isometry3d& scene_from_camera,
                             const DepthNoise& noise, std::uint64_t seed, unsigned threads);

/// Writes depth.png and capture.json into the folder, which is made when it is missing; the base is the scene's frame.
/// Returns capture.json's path.
std::filesystem::path write_depth_capture(const GreyImage& image, const CameraModel& camera,
                                          const Eigen::Isometry3d& scene_from_camera, const DepthNoise& noise,
                                          const std::filesystem::path& folder);

/// Where a camera stands that looks at the scene's middle from its front, so far away and so steep.
Eigen::Isometry3d front_view(const Scene& scene, double distance_mm, double elevation_deg);

}  // namespace seampath
