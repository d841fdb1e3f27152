#pragma once

#include <string>

#include "stages/geometry/grey_image.hpp"

namespace seampath {

/// A grey PNG of 8 or 16 bits, as `white` says. Throws InternalError for a size that a PNG can't have.
std::string png_bytes(const GreyImage& image);

}  // namespace seampath
