#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "datasets/scenes.hpp"
#include "stages/options.hpp"

namespace seampath {

/// A camera with a projector takes a picture at once; a profile sensor (laser line) is carried along the part by a
/// robot.
enum class SensorKind { camera, profile };
inline constexpr std::array<std::string_view, 2> kSensorNames{"camera", "profile"};

/// How the scanner sees. The defaults are the preset `standard`.
struct ScannerOptions {
    SensorKind sensor = SensorKind::camera;
    double sigma_mm = 0.045;   ///< along the ray, face on, at the working distance
    double pitch_x_mm = 0.32;  ///< of pixels on a face-on surface at the working distance; all views together are
    double pitch_y_mm = 0.32;  ///< denser: about 0.2 mm on what all of them see, 0.3 mm on what two see
    double working_distance_mm = 600;
    int views = 6;
    bool organised = false;           ///< keep the raster, with gaps; for one view
    double elevation_deg = 37;        ///< of the views over the plate, give or take 4
    double triangulation_deg = 25;    ///< between camera and projector or laser, seen from the part
    double correlation_px = 1.2;      ///< 1-sigma width of the kernel that ties neighbouring errors; 0: white
    double mixed_pixels = 0.35;       ///< share of pixels at a depth step that fall between its two sides
    double dropout = 0.01;            ///< share of missing pixels, face on
    double blobs = 0.003;             ///< share of the picture lost in spots of 1 to 5 mm
    double outliers = 2e-4;           ///< share of pixels that fly anywhere in the view
    double ghosts = 0.01;             ///< share of pixels near a joint that are seen through the other flank
    double quantisation_mm = 0;       ///< step of depth; 0: none
    double bow_mm = 0;                ///< depth error at the corners of the picture, from the middle
    double scale_error = 0;           ///< largest relative error of size; the seed draws it
    double path_error_mm = 0;         ///< amplitude of the robot's waves that carries a profile sensor
    double registration_mm = 0.015;   ///< 1-sigma of each view's position, per axis
    double registration_deg = 0.003;  ///< 1-sigma of each view's rotation, per axis
};
Fields describe(ScannerOptions&);

inline constexpr std::array<std::string_view, 9> kPresetNames{"standard",      "metrology",     "phoxi_s",
                                                              "zivid2p_m60",   "mecheye_pro_s", "gocator2440_robot",
                                                              "ljx8200_robot", "rgbd",          "worst"};

/// Throws InputError that lists the presets when there is none of this name.
ScannerOptions preset(std::string_view name);

/// One view as a raster, row by row, in the scene's frame; pixels without a measurement are NaN.
struct View {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::vector<Eigen::Vector3d> points;
    /// Error of the view as a whole: a point at p is reported, its noise aside, at error * p.
    Eigen::Affine3d error = Eigen::Affine3d::Identity();
};

/// View `index` of options.views. The same for any number of threads.
View take_view(const Scene& scene, const ScannerOptions& options, std::uint64_t seed, int index, unsigned threads);

}  // namespace seampath
