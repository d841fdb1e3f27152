#pragma once

#include <optional>
#include <vector>

#include "stages/extract/track.hpp"

namespace seampath::detail {

/// The places of the seam along a track: stations at equal steps, each measured anew so that the result does not hang
/// on where following began, ends placed where the first flank ends. Empty when the track, measured with wide windows,
/// turns out to be no joint: flanks too narrow or too rough, points that do not lie on a curve.
std::optional<std::vector<TrackPoint>> measure_track(const Tracker& tracker, const Track& track);

}  // namespace seampath::detail
