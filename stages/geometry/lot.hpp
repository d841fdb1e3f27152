#pragma once

#include <bit>
#include <cstdint>

#include <Eigen/Core>

namespace seampath {

/// A number drawn for a point from its own coordinates: the same in whatever order the points come. Samples of a given
/// share are the points whose lot lies below that share of 2^32.
inline std::uint32_t lot_of(const Eigen::Vector3f& p) {
    std::uint32_t h = 0;
    for (int axis = 0; axis < 3; ++axis) {
        h = (h ^ std::bit_cast<std::uint32_t>(p[axis])) * 0x9e3779b1u;
        h ^= h >> 15;
    }
    h *= 0x85ebca6bu;
    return h ^ (h >> 13);
}

}  // namespace seampath
