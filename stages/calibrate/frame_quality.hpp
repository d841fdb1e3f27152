#pragma once

#include <vector>

#include "stages/calibrate/calibrate.hpp"
#include "stages/calibrate/frame_solver.hpp"

namespace seampath::calibrating {

/// Work point results from displacements of the frame's trials, each a step about `reference`: mean squares and the
/// distance that 95 % keep.
std::vector<WorkPointResult> spread_at(const std::vector<WorkPoint>& work_points, const Eigen::Isometry3d& T,
                                       const std::vector<Eigen::Isometry3d>& trials);

/// Monte-Carlo (GUM Supplement 2): measures the features anew, `factor` times as noisy as their sigmas, and solves
/// again.
void try_at_work_points(const std::vector<FrameFeature>& features, const Solution& solution,
                        const std::vector<WorkPoint>& work_points, const FrameOptions& options, double factor,
                        FrameResult& result);

/// Fills faults and notes from the numbers.
void judge(const FrameOptions& options, FrameResult& result);

}  // namespace seampath::calibrating
