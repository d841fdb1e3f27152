#pragma once

#include <vector>

#include "stages/extract/creases.hpp"
#include "stages/extract/surfels.hpp"
#include "stages/extract/track.hpp"
#include "stages/types.hpp"

namespace seampath::detail {

/// The scan as those see it who look for joints in it. Positions are relative to the scan's origin.
struct Around {
    const Scan& scan;
    const PointGrid& grid;
    const ScaleField& field;
    const Surfels& surfels;
    const std::vector<Crease>& creases;  ///< convex and concave, told apart
    const Tracker& following;            ///< with the windows to follow a seam with
};

}  // namespace seampath::detail
