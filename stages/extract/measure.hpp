#pragma once

#include <optional>

#include "stages/extract/track.hpp"
#include "stages/types.hpp"

namespace seampath::detail {

/// The seam along a track: stations at equal steps, each measured anew so that the result does not hang on where
/// following began, ends placed where the first flank ends. `origin` is added to every position. Empty when the track,
/// measured with wide windows, turns out to be no joint: flanks too narrow or too rough, points that do not lie on a
/// curve.
std::optional<Seam> measure_track(const Tracker& tracker, const Track& track, const Eigen::Vector3d& origin);

}  // namespace seampath::detail
