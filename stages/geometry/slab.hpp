#pragma once

#include <cstdint>

#include <Eigen/Core>

namespace seampath {

/// A scan point of a flank, beside one place of a seam.
struct SlabPoint {
    Eigen::Vector3f p;
    float u;             ///< mm, how far from the seam it lies
    float off;           ///< mm, off the surface that its window found
    std::uint32_t view;  ///< of those that the scan was put together from
};

}  // namespace seampath
