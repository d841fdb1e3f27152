#pragma once

#include <vector>

#include "stages/geometry/grey_image.hpp"
#include "stages/photo/photo.hpp"
#include "stages/photo/track.hpp"

namespace seampath::detail {

/// The line's middle along a track, at even distances, from its first place that is measured to its last; in between,
/// what is not measured is bridged from both sides.
std::vector<PhotoPoint> measure_line(const GreyImage& image, std::vector<TrackPlace> track);

}  // namespace seampath::detail
