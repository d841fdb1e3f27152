#pragma once

#include <vector>

#include "stages/extract/track.hpp"

namespace seampath::detail {

/// Measures the places of a seam once more, by each flank as a whole. Where one plane or cylinder explains a flank
/// along the whole seam, all its points tell where it lies, not only those of one window: the surface is fitted to all
/// of them, and what each place departs from it is kept as far as it is more than noise (a random effect, shrunk by its
/// share of the variance). A flank that no such surface explains better than its own windows do stays as it was
/// measured. Every sigma then holds noise and, from the 1-sigma `registration` (mm) of the views' shifts, what these
/// do. Gives both flanks as surfaces, in the frame of the places.
SeamSurfaces settle_on_whole_flanks(const Tracker& tracker, double registration, std::vector<TrackPoint>& way);

}  // namespace seampath::detail
