#pragma once

#include <vector>

#include "stages/extract/track.hpp"

namespace seampath::detail {

/// The way without single places that lie off the line of those around them, and without open ends that break off it:
/// their fits saw something else, and do not know it. Places of a bend lie off the line with their neighbours, and
/// stay.
std::vector<TrackPoint> without_jumps(std::vector<TrackPoint> way, bool closed);

}  // namespace seampath::detail
