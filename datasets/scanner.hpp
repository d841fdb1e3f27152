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

/// How the scanner sees: a camera and a projector that go round the part. The defaults are the preset `standard`.
struct ScannerOptions {
    double sigma_mm = 0.045;  ///< along the ray, face on, at the working distance
    double pitch_x_mm = 0.3;  ///< of pixels on a face-on surface at the working distance
    double pitch_y_mm = 0.3;
    double working_distance_mm = 600;
    int views = 4;
    double elevation_deg = 45;        ///< of the views over the plate, give or take 6
    double triangulation_deg = 25;    ///< between camera and projector, seen from the part
    double correlation_px = 1.2;      ///< 1-sigma width of the kernel that ties neighbouring errors; 0: white
    double mixed_pixels = 0.35;       ///< share of pixels at a depth step that fall between its two sides
    double dropout = 0.01;            ///< share of missing pixels, face on
    double blobs = 0.003;             ///< share of the picture lost in spots of 1 to 5 mm
    double outliers = 2e-4;           ///< share of pixels that fly anywhere in the view
    double ghosts = 0.01;             ///< share of pixels near a joint that are seen through the other flank
    double quantisation_mm = 0;       ///< of depth; 0: none
    double bow_mm = 0;                ///< depth error from the middle of the picture to its corners
    double scale_error = 0;           ///< largest relative error of size; the seed draws it
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
};

/// What the scanner measures of a scene. The same for any number of threads.
std::vector<View> scan_scene(const Scene& scene, const ScannerOptions& options, std::uint64_t seed, unsigned threads);

}  // namespace seampath
