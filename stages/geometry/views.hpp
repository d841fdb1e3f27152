#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace seampath {

/// Where each view begins in a scan that was put together from several: index of its first point, ascending, to within
/// a few rows. Told from the order of the points: one view sees every place once, so that where points come back to
/// places that the view has left behind, the next one has begun. {0} for one view. One of fewer than a thousand points
/// may be missed.
std::vector<std::size_t> view_starts(std::span<const Eigen::Vector3f> points);

}  // namespace seampath
