#pragma once

#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "stages/calibrate/surfels.hpp"

namespace seampath::calibrating {

/// A pose that many pairs of surfels speak for.
struct PairPose {
    Eigen::Isometry3d base_from_part;
    double votes = 0;
};

/// Poses of the part in a scene without a guess, most votes first: point-pair features (Drost, Ulrich, Navab, Ilic,
/// "Model globally, match locally", CVPR 2010). Pairs that lie in one plane, of which every plane has as many, do not
/// vote. `spacing` is that of the surfels, mm, of which the part's are at most 65535; at most `most` distinct poses.
std::vector<PairPose> pair_feature_poses(std::span<const Surfel> part, std::span<const Surfel> scene, double spacing,
                                         std::size_t most);

}  // namespace seampath::calibrating
