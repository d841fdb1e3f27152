#pragma once

#include <optional>
#include <vector>

#include "stages/types.hpp"
#include "stages/validate/ground.hpp"

namespace seampath::detail {

/// Sets how far the model lies from the line in which both flanks meet, at every sample of even steps along it. Where
/// one plane or cylinder explains a flank along the whole seam, its points all tell where it is, and each sample's own
/// window only what departs from it by more than noise; any other flank is measured window by window. `wall`: height of
/// the second flank where it is a plate's edge, mm. `density` is of points on each flank at a sample, per mm^2; 0: not
/// measured. Gives the robust 1-sigma of single points about the surface of the rougher flank, mm: what the scan's
/// scale calls noise is more than that beside a seam, where few places are free of the corner. 0 when no flank is
/// measured.
double measure_flank_samples(const Ground& ground, const SeamModel& model, const std::optional<double>& wall,
                             std::vector<DeviationSample>& samples, std::vector<double> (&density)[2]);

}  // namespace seampath::detail
