#pragma once

#include <vector>

#include "stages/calibrate/surface_match.hpp"

namespace seampath::calibrating {

/// The nominal surface, fine and coarse.
struct NominalSurface {
    TargetSurface fine, coarse;
};

/// The scan at the resolution of either.
struct ScannedSurface {
    std::vector<SidedPoint> points;  ///< all
    std::vector<SidedPoint> some;    ///< spread over them
    std::vector<Surfel> coarse;
    Seeing seeing;
    double noise_mm = 0;
    std::optional<DepthMap> depth;  ///< where it is known from where all was seen
};

/// A pose that was refined, and what speaks for it.
struct FoundPose {
    FrameFit fit;
    std::size_t seen = 0;    ///< surfels of the fine nominal surface with a point on them
    std::size_t past = 0;    ///< surfels that should be seen, and are seen past
    double information = 0;  ///< geometric mean of the six that those surfels hold, in surfels; 0 when one is open
    bool held() const { return information > 0; }
};

/// Distinct poses, those with most information first, then those with an open direction by what is seen.
std::vector<FoundPose> search_poses(const NominalSurface& nominal, const ScannedSurface& scan, double weak_ratio);

}  // namespace seampath::calibrating
