#pragma once

#include <Eigen/Geometry>

#include "stages/geometry/camera.hpp"
#include "stages/geometry/grey_image.hpp"
#include "stages/types.hpp"

namespace seampath {

/// A depth image as a scan.
struct DepthScan {
    Scan scan;                        ///< organised: a point's pixel is that of the image; base's frame
    std::uint64_t without_depth = 0;  ///< pixels of value 0, or that no ray of the lens model meets
    std::uint64_t mixed = 0;          ///< pixels left out because their light came from both sides of a step
    double noise_per_mm2 = 0;         ///< 1-sigma of a depth z is this times z^2
};

/// Points where the pixels' rays, the lens's distortion undone, have the image's depths along the camera's axis.
///
/// A mixed pixel lies between the two sides of a step in depth and on neither. Seen along a row or a column: its
/// neighbours are further apart than a surface at 80 degrees would be, and it is off what either side, drawn out, would
/// show, by more than five sigmas of noise. That noise, which of triangulating sensors grows with z^2, is the image's
/// own: from second differences along rows. The image has the camera's size, and holds at least one depth.
DepthScan scan_of_depth(const GreyImage& depth, const CameraModel& camera, double mm_per_unit,
                        const Eigen::Isometry3d& base_from_camera);

}  // namespace seampath
