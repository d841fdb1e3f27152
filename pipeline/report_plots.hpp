#pragma once

#include <cstddef>
#include <string>

#include "pipeline/result.hpp"

namespace seampath {

/// The plots of one seam as HTML figures: deviation along the seam, its histogram, curvature with the nodes, torch
/// speed.
std::string seam_plots(const PartResult& part, std::size_t seam);

}  // namespace seampath
