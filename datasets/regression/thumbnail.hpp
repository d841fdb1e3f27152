#pragma once

#include <string>

#include "pipeline/result.hpp"

namespace seampath {

/// A small drawing of a part, an SVG: scan points and seams along the direction in which the scan is thinnest.
std::string thumbnail_svg(const PartResult& part);

}  // namespace seampath
