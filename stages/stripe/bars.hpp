#pragma once

#include <vector>

#include "stages/geometry/grey_image.hpp"

namespace seampath {

/// A piece of one column that is brighter than what lies above and below it.
struct Bar {
    float y = 0;         ///< its middle, px
    float height = 0;    ///< px
    float contrast = 0;  ///< mean over that of the brighter side, grey values
    float strength = 0;  ///< contrast over its 1-sigma of noise
};

/// 1-sigma of white noise, grey values, from pixels two columns apart; at least that of rounding to whole values.
double noise_of(const GreyImage& image);

/// Per column its bars from top to bottom: where the strength has a peak over rows and heights, and is above `least`.
std::vector<std::vector<Bar>> find_bars(const GreyImage& image, double noise, double least);

}  // namespace seampath
