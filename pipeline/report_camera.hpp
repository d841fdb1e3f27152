#pragma once

#include <span>

#include "pipeline/report_view.hpp"

namespace seampath {

/// The direction from which these seams are seen best: from the air side of both flanks, with the least hidden behind
/// the part. The flank that most of the seams share stands upright. Without seams: from the sensor, where it is known.
/// `scene` gives centre, radius and clouds.
ViewCamera best_camera(std::span<const Seam> seams, const Scan& scan, const ViewScene& scene);

}  // namespace seampath
