#pragma once

#include "stages/options.hpp"
#include "stages/types.hpp"

namespace seampath {

struct PlaceOptions {
    double chord_tolerance_mm = 0.05;
    double max_spacing_mm = 25;
};
Fields describe(PlaceOptions&);

/// Fewest seam points such that every seam point lies within the chord tolerance of its interval's chord: every sample
/// under the chord is tested, not only the middle. Denser where curvature is high.
Nodes place(const Seam& seam, const PlaceOptions& options);

}  // namespace seampath
