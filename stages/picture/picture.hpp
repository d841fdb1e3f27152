#pragma once

#include <string>
#include <string_view>

#include "stages/geometry/grey_image.hpp"

namespace seampath {

/// Decodes a grey PNG of 1 to 16 bits a pixel. `name` is for messages. Throws InputError for what is no PNG, has colour
/// or transparency, or is damaged; never allocates more than so many bytes can hold.
GreyImage decode_picture(std::string_view bytes, const std::string& name);

/// Decodes a photograph, PNG or JPEG, to its brightness: 0.299 red + 0.587 green + 0.114 blue; transparency is ignored.
/// Throws as decode_picture() does.
GreyImage decode_photograph(std::string_view bytes, const std::string& name);

/// A grey JPEG of 8 bits, brightness as it is. Throws InternalError for a size that a JPEG can't have.
std::string jpeg_bytes(const GreyImage& image);

}  // namespace seampath
