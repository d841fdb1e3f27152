#pragma once

#include <vector>

#include "stages/extract/track.hpp"

namespace seampath::detail {

/// Joins ends of tracks that face each other across a stretch that the scanner did not see: shadow, dropout, spatter.
/// Bridged points are marked as modelled. A stretch where one flank can be seen to go on past the place where the other
/// should stand is no gap in the scan but in the part, and is left open.
std::vector<Track> join_tracks(const Tracker& tracker, std::vector<Track> tracks);

}  // namespace seampath::detail
