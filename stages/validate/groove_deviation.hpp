#pragma once

#include <span>
#include <vector>

#include "stages/geometry/bspline.hpp"
#include "stages/geometry/grid.hpp"
#include "stages/geometry/scale.hpp"
#include "stages/types.hpp"

namespace seampath::detail {

/// Measures the groove's section at every sample's station and sets how far the model's point is from its root:
/// `flank1_mm` and `flank2_mm` are that distance along the bevels' normals. `density` is of each bevel's points there.
/// `view_starts` as for groove_points.
void measure_groove_samples(const SeamModel& model, const ArcLength& arc, const Eigen::Vector3d& origin,
                            const PointGrid& grid, std::span<const std::size_t> view_starts, const ScanScale& scale,
                            std::vector<DeviationSample>& samples, std::vector<double> (&density)[2]);

}  // namespace seampath::detail
