#include <string>

#include "datasets/scanner.hpp"
#include "pipeline/text.hpp"
#include "stages/error.hpp"

namespace seampath {
namespace {

/// Figures of the makers and of Nguyen et al. (2012) for the depth camera; where a maker's figure is of an average over
/// many points (profile sensors), the noise of a single point on ground steel.
using Apply = void (*)(ScannerOptions&);
constexpr std::array<Apply, kPresetNames.size()> kPresets{
    [](ScannerOptions&) {},
    [](ScannerOptions& o) {  // metrology: blue-light fringe projection on matte spray
        o.views = 4;
        o.sigma_mm = 0.01;
        o.working_distance_mm = 500;
        o.pitch_x_mm = o.pitch_y_mm = 0.08;
        o.bow_mm = 0.01;
        o.scale_error = 2e-5;
        o.dropout = 0.005;
        o.outliers = 1e-5;
        o.registration_mm = 0.005;
        o.registration_deg = 0.001;
    },
    [](ScannerOptions& o) {  // phoxi_s: baseline 230 mm
        o.sigma_mm = 0.03;
        o.working_distance_mm = 442;
        o.triangulation_deg = 27.5;
        o.pitch_x_mm = o.pitch_y_mm = 0.16;
        o.bow_mm = 0.22;
        o.scale_error = 1.25e-3;
        o.dropout = 0.02;
        o.registration_mm = 0.03;
        o.registration_deg = 0.01;
    },
    [](ScannerOptions& o) {  // zivid2p_m60
        o.sigma_mm = 0.08;
        o.pitch_x_mm = o.pitch_y_mm = 0.24;
        o.bow_mm = 0.1;
        o.scale_error = 2e-3;
        o.dropout = 0.02;
        o.registration_mm = 0.03;
        o.registration_deg = 0.01;
    },
    [](ScannerOptions& o) {  // mecheye_pro_s: 0.05 mm at 1 m, used at half of that; baseline 180 mm
        o.sigma_mm = 0.0125;
        o.working_distance_mm = 500;
        o.triangulation_deg = 20;
        o.pitch_x_mm = o.pitch_y_mm = 0.19;
        o.bow_mm = 0.1;
        o.dropout = 0.03;
        o.outliers = 3e-4;
        o.registration_mm = 0.03;
        o.registration_deg = 0.01;
    },
    [](ScannerOptions& o) {  // gocator2440_robot
        o.views = 4;
        o.sensor = SensorKind::profile;
        o.sigma_mm = 0.03;
        o.working_distance_mm = 400;
        o.pitch_x_mm = 0.025;
        o.pitch_y_mm = 0.2;
        o.correlation_px = 3;
        o.bow_mm = 0.018;
        o.path_error_mm = 0.05;
        o.quantisation_mm = 0.001;
        o.dropout = 0.05;
        o.outliers = 5e-4;
        o.ghosts = 0.03;
    },
    [](ScannerOptions& o) {  // ljx8200_robot
        o.views = 4;
        o.sensor = SensorKind::profile;
        o.sigma_mm = 0.04;
        o.working_distance_mm = 400;
        o.pitch_x_mm = 0.031;
        o.pitch_y_mm = 0.1;
        o.correlation_px = 3;
        o.path_error_mm = 0.05;
        o.quantisation_mm = 0.004;
        o.dropout = 0.05;
        o.outliers = 5e-4;
        o.ghosts = 0.03;
    },
    [](ScannerOptions& o) {  // rgbd: sigma_z(0.7 m) = 0.0012 + 0.0019 (0.7 - 0.4)^2 m; baseline 75 mm
        o.sigma_mm = 1.37;
        o.working_distance_mm = 700;
        o.triangulation_deg = 6;
        o.pitch_x_mm = o.pitch_y_mm = 1.2;
        o.scale_error = 0.01;
        o.dropout = 0.1;
        o.outliers = 2e-3;
        o.registration_mm = 0.5;
        o.registration_deg = 0.1;
    },
    [](ScannerOptions& o) {  // worst: no measurement is expected of this
        o.sigma_mm = 0.2;
        o.pitch_x_mm = 0.5;
        o.pitch_y_mm = 1;
        o.bow_mm = 0.3;
        o.dropout = 0.3;
        o.outliers = 1e-2;
        o.ghosts = 0.08;
        o.registration_mm = 0.5;
        o.registration_deg = 0.03;
    },
};

}  // namespace

Fields describe(ScannerOptions& o) {
    return {
        {"sensor", choice(o.sensor, kSensorNames), "camera with projector, or profile sensor on a robot"},
        {"sigma_mm", &o.sigma_mm, "noise along the ray, face on, at the working distance", at_least(0)},
        {"pitch_x_mm", &o.pitch_x_mm, "distance of pixels on a face-on surface, across", above(0)},
        {"pitch_y_mm", &o.pitch_y_mm, "distance of pixels on a face-on surface, down", above(0)},
        {"working_distance_mm", &o.working_distance_mm, "from the camera to the middle of the part", above(0)},
        {"views", &o.views, "stations round the part", within(1, 36)},
        {"organised", &o.organised, "keep the raster of the one view, with gaps"},
        {"elevation_deg", &o.elevation_deg, "of the stations over the plate", within(10, 80)},
        {"triangulation_deg", &o.triangulation_deg, "between camera and projector, seen from the part", within(1, 60)},
        {"correlation_px", &o.correlation_px, "width of the kernel that ties neighbouring errors; 0: white",
         within(0, 20)},
        {"mixed_pixels", &o.mixed_pixels, "share of pixels at a depth step that fall between its sides", within(0, 1)},
        {"dropout", &o.dropout, "share of missing pixels, face on", within(0, 0.95)},
        {"blobs", &o.blobs, "share of the picture lost in spots of 1 to 5 mm", within(0, 0.95)},
        {"outliers", &o.outliers, "share of pixels that fly anywhere in the view", within(0, 1)},
        {"ghosts", &o.ghosts, "share of pixels near a joint seen through its other flank", within(0, 1)},
        {"quantisation_mm", &o.quantisation_mm, "step of depth; 0: none", at_least(0)},
        {"bow_mm", &o.bow_mm, "depth error from the middle of the picture to its corners"},
        {"scale_error", &o.scale_error, "largest relative error of size", within(0, 0.1)},
        {"path_error_mm", &o.path_error_mm, "amplitude of the robot's waves that carries a profile sensor",
         at_least(0)},
        {"registration_mm", &o.registration_mm, "1-sigma of each view's position, per axis", at_least(0)},
        {"registration_deg", &o.registration_deg, "1-sigma of each view's rotation, per axis", at_least(0)}};
}

ScannerOptions preset(std::string_view name) {
    for (std::size_t i = 0; i < kPresets.size(); ++i) {
        if (kPresetNames[i] == name) {
            ScannerOptions options;
            kPresets[i](options);
            return options;
        }
    }
    throw InputError("dataset: there is no preset \"" + std::string(name) + "\"; the presets are " +
                     join(kPresetNames) + hint(name, kPresetNames));
}

}  // namespace seampath
