#pragma once

#include <span>
#include <vector>

#include "stages/calibrate/calibrate.hpp"
#include "stages/calibrate/surface_match.hpp"

namespace seampath::calibrating {

/// A number without pattern for an index (SplitMix64's finaliser), to take some of many in no order.
inline std::uint64_t stride_hash(std::uint64_t z) {
    z = (z + 0x9e3779b97f4a7c15) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
}

/// Fills the result from a fit that came to rest: frame, covariance, weak directions, faces, work points, faults. Gives
/// the largest ratio of variance to that of independent points.
double judge_surface(const TargetSurface& surface, std::span<const SidedPoint> points, const FrameFit& fit,
                     const std::vector<WorkPoint>& work_points, const FrameOptions& options, FrameResult& result);

}  // namespace seampath::calibrating
