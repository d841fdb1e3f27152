#include "datasets/picture_file.hpp"

#include <cstdint>

#include <png.h>

#include "stages/error.hpp"

namespace seampath {

std::string png_bytes(const GreyImage& image) {
    const bool wide = image.white > 255;
    std::vector<std::uint16_t> wide_pixels;
    std::vector<std::uint8_t> pixels;
    for (const float grey : image.value) {
        wide ? wide_pixels.push_back(static_cast<std::uint16_t>(grey))
             : pixels.push_back(static_cast<std::uint8_t>(grey));
    }
    png_image head{};
    head.version = PNG_IMAGE_VERSION;
    head.width = static_cast<std::uint32_t>(image.width);
    head.height = static_cast<std::uint32_t>(image.height);
    // "Linear" is libpng's word for 16 bits; the numbers are written as they are.
    head.format = wide ? PNG_FORMAT_LINEAR_Y : PNG_FORMAT_GRAY;
    const void* data = wide ? static_cast<const void*>(wide_pixels.data()) : pixels.data();
    png_alloc_size_t size = 0;
    std::string bytes;
    bool written = png_image_write_to_memory(&head, nullptr, &size, 0, data, 0, nullptr);
    if (written) {
        bytes.resize(size);
        written = png_image_write_to_memory(&head, bytes.data(), &size, 0, data, 0, nullptr);
    }
    ensure(written, "libpng writes every grey picture");
    return bytes;
}

}  // namespace seampath
