#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "stages/geometry/grey_image.hpp"

/// Pictures of laser stripes with known middles.
namespace seampath {

/// What a picture shows: stripes whose middles are polylines, px (x to the right, y down, from the middle of the first
/// pixel), and whose height over the ground is a Gaussian of the distance from it.
struct StripePicture {
    int width = 640;
    int height = 240;
    std::vector<std::vector<Eigen::Vector2d>> courses;
    double width_px = 3;  ///< at half of the height
    double peak = 200;    ///< grey values
    double ground = 20;   ///< grey values
};

/// What spoils it.
struct StripeNoise {
    double sigma = 3;            ///< of each pixel, grey values
    double speckle = 0;          ///< 1-sigma of the stripe's brightness, grains of two pixels, relative
    double halo = 0;             ///< height of a second reflection on one side of the stripe, relative
    double halo_offset_px = 4;   ///< its distance below the stripe
    double exposure = 1;         ///< all light times this; what is over white is cut off
    double glow = 0;             ///< height of an arc's light, grey values
    double glow_radius_px = 60;  ///< 1-sigma of its extent
    Eigen::Vector2d glow_at{0, 0};
    double dropout = 0;  ///< share of the columns in which the stripe is not seen, in runs of eight
};

/// The same bytes for the same seed. Grey values are whole, 0 to 255.
GreyImage draw_stripes(const StripePicture& picture, const StripeNoise& noise, std::uint64_t seed);

}  // namespace seampath
