#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace seampath {

/// Where the scan is, whatever lies around it.
struct Bulk {
    Eigen::Vector3d middle{0, 0, 0};  ///< mean, mm
    double extent = 0;                ///< mm, of the longest axis, without what lies four standard deviations off
};

/// Needs points.
Bulk bulk_of(std::span<const Eigen::Vector3f> points);

/// Flags of the points that lie within a hundred extents of the bulk of the scan; empty when all do. A single return
/// from the end of the world must not set the size of a grid's cells.
std::vector<std::uint8_t> without_strays(std::span<const Eigen::Vector3f> points);

}  // namespace seampath
