#pragma once

#include <vector>

#include "stages/geometry/grey_image.hpp"
#include "stages/photo/track.hpp"

namespace seampath::detail {

/// A place of the track and how the line looks there.
struct LinePlace {
    TrackPlace track;
    double width = 0;  ///< px
    double level = 0;  ///< grey value between the line and the side that is more like it
};

/// How the line looks about a place of the track. Its mean profile is as wide as it is between the places where the
/// grey is half way to either side's; as wide as the track says where it shows no such places.
LinePlace look_of(const GreyImage& image, const std::vector<TrackPlace>& track, std::size_t middle);

/// The line's middle at one column.
struct RidgeSight {
    double y = 0;
    bool seen = false;
};

/// The line's middle at each place by Steger's ridge.
std::vector<RidgeSight> sights_of(const GreyImage& image, const std::vector<LinePlace>& places);

/// Sigma of the Gaussian that a line is looked at with, px.
double ridge_sigma(double width);

}  // namespace seampath::detail
