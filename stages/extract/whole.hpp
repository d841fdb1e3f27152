#pragma once

#include <span>
#include <vector>

#include "stages/extract/view_shifts.hpp"

namespace seampath::detail {

/// Measures the places of a scan's seams once more, by each flank as a whole. First all views are moved back by what
/// all flanks together tell of their shifts. Then, where one plane or cylinder explains a flank along the whole seam,
/// all its points tell where it lies, not only those of one window: the surface is fitted to all of them, and what each
/// place departs from it is kept as far as it is more than noise (a random effect, shrunk by its share of the
/// variance). A flank that no such surface explains better than its own windows do stays as it was measured. Every
/// sigma then holds noise and what stays unknown of the views' shifts, whose 1-sigma is `registration` (mm). Gives both
/// flanks of each seam as surfaces, in the frame of the places.
std::vector<SeamSurfaces> settle_on_whole_flanks(std::span<const MeasuredWay> ways, double registration);

}  // namespace seampath::detail
