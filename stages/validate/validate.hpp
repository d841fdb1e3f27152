#pragma once

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

/// What a verdict adds to p99.7 before it holds it against the tolerance: two of the usual 1-sigmas of the checked
/// samples (ISO 14253-1), mm.
double guard_mm(const Deviation& deviation);

}  // namespace seampath
