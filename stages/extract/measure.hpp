#pragma once

#include "stages/extract/track.hpp"
#include "stages/types.hpp"

namespace seampath::detail {

/// The seam along a track: stations at equal steps, each measured anew so that the result does not hang on where following
/// began, ends placed where the first flank ends. `origin` is added to every position.
Seam measure_track(const Tracker& tracker, const Track& track, const Eigen::Vector3d& origin);

}  // namespace seampath::detail
