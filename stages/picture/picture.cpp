#include "stages/picture/picture.hpp"

#include <array>
#include <csetjmp>
#include <cstdint>
#include <cstdio>
#include <cstring>

#include <png.h>

#include "stages/error.hpp"
#include "stages/picture/jpeg.hpp"

namespace seampath {
namespace {

constexpr std::string_view kPngMagic = "\x89PNG\r\n\x1a\n";
constexpr std::uint32_t kMostPixelsASide = 1 << 15;
constexpr std::uint64_t kMostPerByte = 1032;  // what a deflated byte can stand for at the most

/// A picture while libpng takes it apart. Its errors come as long jumps, so nothing with a destructor lives in the
/// functions that call setjmp.
struct PngReader {
    explicit PngReader(std::string_view file) : bytes(file) {}
    ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
    PngReader(const PngReader&) = delete;
    PngReader& operator=(const PngReader&) = delete;

    std::string_view bytes;
    std::size_t at = 0;
    png_structp png = nullptr;
    png_infop info = nullptr;
    std::array<char, 120> reason{};
};

[[noreturn]] void leave(png_structp png, png_const_charp what) {
    auto& reader = *static_cast<PngReader*>(png_get_error_ptr(png));
    std::snprintf(reader.reason.data(), reader.reason.size(), "%s", what);
    png_longjmp(png, 1);
}

void ignore_warning(png_structp, png_const_charp) {}

void give_bytes(png_structp png, png_bytep to, png_size_t count) {
    auto& reader = *static_cast<PngReader*>(png_get_io_ptr(png));
    if (count > reader.bytes.size() - reader.at) {
        png_error(png, "it ends before its last row");
    }
    std::memcpy(to, reader.bytes.data() + reader.at, count);
    reader.at += count;
}

bool read_png_header(PngReader& reader) {
    if (setjmp(png_jmpbuf(reader.png))) {
        return false;
    }
    png_set_read_fn(reader.png, &reader, give_bytes);
    png_set_user_limits(reader.png, kMostPixelsASide, kMostPixelsASide);
    png_read_info(reader.png, reader.info);
    return true;
}

bool read_png_rows(PngReader& reader, png_bytepp rows) {
    if (setjmp(png_jmpbuf(reader.png))) {
        return false;
    }
    png_set_expand(reader.png);
    png_set_strip_alpha(reader.png);
    if (png_get_color_type(reader.png, reader.info) & PNG_COLOR_MASK_COLOR) {
        png_set_rgb_to_gray(reader.png, PNG_ERROR_ACTION_NONE, 0.299, 0.587);
    }
    png_set_interlace_handling(reader.png);
    png_read_update_info(reader.png, reader.info);
    png_read_image(reader.png, rows);
    png_read_end(reader.png, nullptr);
    return true;
}

[[noreturn]] void refuse(const std::string& name, const std::string& what) {
    throw InputError("read: " + name + ": " + what);
}

[[noreturn]] void refuse_damaged(const std::string& name, const PngReader& reader) {
    refuse(name, "is a damaged PNG: " + std::string(reader.reason.data()) +
                     "; a whole picture was needed; save or copy it again");
}

void check_grey(const std::string& name, const PngReader& reader) {
    const int type = png_get_color_type(reader.png, reader.info);
    if (type != PNG_COLOR_TYPE_GRAY) {
        const std::string what = type == PNG_COLOR_TYPE_PALETTE
                                     ? "a palette"
                                     : std::to_string(png_get_channels(reader.png, reader.info)) + " channels";
        refuse(name, "has " + what + "; a grey picture of one channel was needed; save it without colour");
    }
}

enum class Colour { refused, to_brightness };

GreyImage decode_png(std::string_view bytes, const std::string& name, Colour colour) {
    PngReader reader(bytes);
    reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reader, leave, ignore_warning);
    reader.info = reader.png ? png_create_info_struct(reader.png) : nullptr;
    if (!reader.info || !read_png_header(reader)) {
        refuse_damaged(name, reader);
    }
    if (colour == Colour::refused) {
        check_grey(name, reader);
    }
    const std::uint32_t width = png_get_image_width(reader.png, reader.info);
    const std::uint32_t height = png_get_image_height(reader.png, reader.info);
    const bool wide = png_get_bit_depth(reader.png, reader.info) == 16;
    const std::size_t stride = std::size_t{width} * (wide ? 2 : 1);
    if (std::uint64_t{stride} * height / 8 > kMostPerByte * bytes.size()) {
        refuse(name, "is a damaged PNG: " + std::to_string(bytes.size()) + " bytes can't hold " +
                         std::to_string(width) + " x " + std::to_string(height) + " pixels; save or copy it again");
    }
    std::vector<png_byte> pixels(stride * height);
    std::vector<png_bytep> rows(height);
    for (std::size_t r = 0; r < height; ++r) {
        rows[r] = pixels.data() + r * stride;
    }
    if (!read_png_rows(reader, rows.data())) {
        refuse_damaged(name, reader);
    }
    GreyImage image{static_cast<int>(width), static_cast<int>(height), wide ? 65535.0 : 255.0, {}};
    image.value.resize(std::size_t{width} * height);
    for (std::size_t i = 0; i < image.value.size(); ++i) {
        image.value[i] = wide ? static_cast<float>(pixels[2 * i] << 8 | pixels[2 * i + 1]) : pixels[i];
    }
    return image;
}

}  // namespace

GreyImage decode_picture(std::string_view bytes, const std::string& name) {
    if (!bytes.starts_with(kPngMagic)) {
        refuse(name, "is no PNG; a grey PNG was needed; convert the picture");
    }
    return decode_png(bytes, name, Colour::refused);
}

GreyImage decode_photograph(std::string_view bytes, const std::string& name) {
    if (bytes.starts_with("\xff\xd8\xff")) {
        return detail::decode_jpeg(bytes, name);
    }
    if (!bytes.starts_with(kPngMagic)) {
        refuse(name, "is no JPEG and no PNG; a photograph as one of the two was needed; convert it");
    }
    return decode_png(bytes, name, Colour::to_brightness);
}

}  // namespace seampath
