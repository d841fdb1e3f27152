#include <string>

#include "datasets/scanner.hpp"
#include "stages/error.hpp"

namespace seampath {

Fields describe(ScannerOptions& o) {
    return {
        {"sensor", choice(o.sensor, kSensorNames), "camera with projector, or profile sensor on a robot"},
        {"sigma_mm", &o.sigma_mm, "noise along the ray, face on, at the working distance", at_least(0)},
        {"pitch_x_mm", &o.pitch_x_mm, "distance of pixels on a face-on surface, across", above(0)},
        {"pitch_y_mm", &o.pitch_y_mm, "distance of pixels on a face-on surface, down", above(0)},
        {"working_distance_mm", &o.working_distance_mm, "from the camera to the middle of the part", above(0)},
        {"views", &o.views, "stations round the part", within(1, 36)},
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
    if (name == "standard") {
        return {};
    }
    std::string known;
    for (const std::string_view preset_name : kPresetNames) {
        known += (known.empty() ? "" : ", ") + std::string(preset_name);
    }
    throw InputError("dataset: there is no preset \"" + std::string(name) + "\"; use one of " + known);
}

}  // namespace seampath
