#pragma once

#include <string>
#include <string_view>

#include "stages/geometry/grey_image.hpp"

namespace seampath::detail {

/// The brightness of a JPEG, 8 bits. Throws InputError for what is damaged.
GreyImage decode_jpeg(std::string_view bytes, const std::string& name);

}  // namespace seampath::detail
