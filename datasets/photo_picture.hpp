#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "stages/geometry/grey_image.hpp"

/// Photographs of flat joints with known middles.
namespace seampath {

/// Two sheets and the gap between them.
struct PhotoPicture {
    int width = 640;
    int height = 480;
    std::vector<Eigen::Vector2d> course;         ///< middle of the gap, px; it ends at or beyond the picture's borders
    double gap_px = 6;                           ///< between the sheets' edges
    double gap_grey = 25;                        ///< darker or brighter than the sheets
    std::array<double, 2> sheet_grey{120, 120};  ///< right and left of the course, seen along it
};

/// What spoils it.
struct PhotoNoise {
    double texture = 0.1;      ///< 1-sigma of the sheets' brightness, grains of 2 to 32 px, relative
    double rust = 0.3;         ///< share of the sheets that is covered by patches a third darker
    double shade = 0.4;        ///< the light falls off by so much from one corner to the other, relative
    int tacks = 0;             ///< welded over the gap, grey and white
    int holes = 0;             ///< burnt beside and through the gap, black
    double spot_px = 16;       ///< radius of tacks and holes, give or take a third
    int highlights = 0;        ///< white, anywhere
    double highlight_px = 30;  ///< 1-sigma of their extent
    double blur_px = 0.8;      ///< 1-sigma of the lens
    double sigma = 2;          ///< of each pixel, grey values
};

/// The same bytes for the same seed. Grey values are whole, 0 to 255.
GreyImage draw_photo(const PhotoPicture& picture, const PhotoNoise& noise, std::uint64_t seed);

}  // namespace seampath
