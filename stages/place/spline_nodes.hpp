#pragma once

#include "stages/place/place.hpp"
#include "stages/place/smooth_line.hpp"

/// Private to the place stage: where nodes of a cubic spline lie.
namespace seampath {

/// `spline` of place.hpp.
Chosen nodes_by_error(const SmoothLine& line, const PlaceOptions& options);

/// `uniform` of place.hpp.
Chosen nodes_at_equal_steps(const SmoothLine& line, const PlaceOptions& options);

}  // namespace seampath
