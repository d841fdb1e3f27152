#pragma once

#include "stages/types.hpp"
#include "stages/validate/validate.hpp"

namespace seampath::detail {

inline constexpr double kNoiseTolerance = 3;  ///< tolerance by default, in sigmas of a single measurement

/// Sets statistics and verdict from the samples and `tolerance_mm`.
void summarise(Deviation& result, const ValidateOptions& options);

}  // namespace seampath::detail
