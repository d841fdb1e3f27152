#pragma once

#include <string>
#include <string_view>

#include "stages/geometry/grey_image.hpp"

namespace seampath {

/// Decodes a grey PNG of 1 to 16 bits a pixel. `name` is for messages. Throws InputError for what is no PNG, has colour
/// or transparency, or is damaged; never allocates more than so many bytes can hold.
GreyImage decode_picture(std::string_view bytes, const std::string& name);

}  // namespace seampath
