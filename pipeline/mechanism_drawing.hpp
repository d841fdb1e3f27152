#pragma once

#include <span>
#include <string>

#include "stages/mechanism/mechanism.hpp"

namespace seampath {

/// The interpolation grid of a two-tier mechanism with a polyline and the way over the grid that follows it, as an SVG
/// file: figure 2 of Naumov et al. Of a fine grid every so many lines are drawn.
std::string mechanism_svg(const TwoTierGrid& grid, std::span<const Eigen::Vector2d> polyline, const GridPath& path);

}  // namespace seampath
