#pragma once

#include "stages/geometry/photo_view.hpp"
#include "stages/options.hpp"
#include "stages/types.hpp"

namespace seampath {

struct ValidateOptions {
    double tolerance_mm = 0;  ///< 0: from the noise of the points on the flanks
    double min_coverage = 0.9;
};
Fields describe(ValidateOptions&);

/// Deviation of the model from the raw scan's two flank surfaces, and the verdict.
Deviation validate(const SeamModel& model, const Scan& scan, const ValidateOptions& options);

/// Deviation of the model from the seam as the photograph's own grey values show it, station by station: the middle of
/// the line's two edges, where the grey is half way between the line's and each side's. That knows nothing of ridges or
/// of how the seam was found. Stations where no line stands out, or that are bridged, are not covered. It tells whether
/// the model lies on a line of the photograph, not whether that line is the seam.
Deviation validate(const SeamModel& model, const PhotoView& view, const ValidateOptions& options);

/// What a verdict adds to p99.7 before it holds it against the tolerance: two of the usual 1-sigmas of the checked
/// samples (ISO 14253-1), mm.
double guard_mm(const Deviation& deviation);

/// Whether the tolerance is one that nobody asked for, only what the scan's noise allows, and wider than the welds of
/// thin plates can bear.
bool wide_by_noise(const Deviation& deviation, const ValidateOptions& options);

}  // namespace seampath
