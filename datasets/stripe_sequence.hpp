#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <Eigen/Geometry>

#include "datasets/scenes.hpp"
#include "datasets/stripe_picture.hpp"
#include "stages/geometry/camera.hpp"

/// A laser line carried along a part by a robot, picture by picture.
namespace seampath {

/// The sensor, and how it is carried. The laser's plane is square to travel, which is along the scene's x.
struct StripeRig {
    double tilt_deg = 45;           ///< of the laser, from upright to the scene's +y side
    double triangulation_deg = 25;  ///< between laser and camera, which follows in travel
    double distance_mm = 200;       ///< of both from the middle of the seam
    double focal_px = 1500;
    int width = 640;
    int height = 240;
    std::array<double, 5> distortion{-0.12, 0.08, 0.0004, -0.0003, 0};
    int images = 200;
    double step_mm = 0.4;
    double stripe_width_px = 3;
};

struct StripeSequence {
    CameraModel camera;
    Eigen::Vector3d plane_normal;  ///< unit, of the laser's plane in the camera's frame: n p = distance
    double plane_distance_mm = 0;
    std::vector<GreyImage> images;
    std::vector<Eigen::Isometry3d> base_from_camera;  ///< one an image; the base is the scene's frame
    Truth truth;
};

/// What the sensor sees of the scene while it passes its middle, from its surfaces exactly: a place shows where it sees
/// both the laser and the camera. All from one seed; the same for any number of threads.
StripeSequence make_stripe_sequence(const SceneOptions& scene, const StripeRig& rig, const StripeNoise& noise,
                                    std::uint64_t seed, unsigned threads);

/// Writes 000.png ... and capture.json into the folder, which is made when it is missing. Returns capture.json's path.
std::filesystem::path write_stripe_sequence(const StripeSequence& sequence, const std::filesystem::path& folder);

}  // namespace seampath
