#include "stages/picture/jpeg.hpp"

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstdint>
#include <cstdio>  // jpeglib.h needs it
#include <cstdlib>

#include <jpeglib.h>

#include "stages/error.hpp"
#include "stages/picture/picture.hpp"

namespace seampath::detail {
namespace {

constexpr unsigned kMostJpegSide = 1 << 15;
constexpr std::uint64_t kMostPixelsPerByte = 2048;  // an 8 x 8 block takes a few bits at the least

/// A picture while libjpeg takes it apart. As in picture.cpp: its errors come as long jumps.
struct JpegReader {
    JpegReader() { decoder.err = jpeg_std_error(&errors); }
    ~JpegReader() { jpeg_destroy_decompress(&decoder); }
    JpegReader(const JpegReader&) = delete;
    JpegReader& operator=(const JpegReader&) = delete;

    jpeg_decompress_struct decoder{};
    jpeg_error_mgr errors{};
    std::jmp_buf out{};
    std::array<char, JMSG_LENGTH_MAX> reason{};
};

void keep_reason(j_common_ptr decoder) {
    auto& reader = *static_cast<JpegReader*>(decoder->client_data);
    decoder->err->format_message(decoder, reader.reason.data());
}

[[noreturn]] void leave_jpeg(j_common_ptr decoder) {
    keep_reason(decoder);
    std::longjmp(static_cast<JpegReader*>(decoder->client_data)->out, 1);
}

/// libjpeg goes on after warnings, e.g. of a file that was cut off, with grey where nothing was read.
void refuse_warning(j_common_ptr decoder, int level) {
    if (level < 0) {
        leave_jpeg(decoder);
    }
}

bool read_jpeg_header(JpegReader& reader, std::string_view bytes) {
    if (setjmp(reader.out)) {
        return false;
    }
    jpeg_mem_src(&reader.decoder, reinterpret_cast<const unsigned char*>(bytes.data()),
                 static_cast<unsigned long>(bytes.size()));
    jpeg_read_header(&reader.decoder, TRUE);
    return true;
}

bool read_jpeg_rows(JpegReader& reader, unsigned char* pixels) {
    if (setjmp(reader.out)) {
        return false;
    }
    reader.decoder.out_color_space = JCS_GRAYSCALE;
    reader.decoder.dct_method = JDCT_ISLOW;  // whole numbers: the same picture on every processor
    jpeg_start_decompress(&reader.decoder);
    while (reader.decoder.output_scanline < reader.decoder.output_height) {
        unsigned char* row =
            pixels + std::size_t{reader.decoder.output_scanline} * std::size_t{reader.decoder.output_width};
        jpeg_read_scanlines(&reader.decoder, &row, 1);
    }
    jpeg_finish_decompress(&reader.decoder);
    return true;
}

[[noreturn]] void refuse_jpeg(const std::string& name, const std::string& reason) {
    throw InputError("read: " + name + ": is a damaged JPEG: " + reason +
                     "; a whole picture was needed; save or copy it again");
}

}  // namespace

GreyImage decode_jpeg(std::string_view bytes, const std::string& name) {
    JpegReader reader;
    reader.decoder.client_data = &reader;
    reader.errors.error_exit = leave_jpeg;
    reader.errors.emit_message = refuse_warning;
    jpeg_create_decompress(&reader.decoder);
    if (!read_jpeg_header(reader, bytes)) {
        refuse_jpeg(name, reader.reason.data());
    }
    const unsigned width = reader.decoder.image_width, height = reader.decoder.image_height;
    if (width > kMostJpegSide || height > kMostJpegSide ||
        std::uint64_t{width} * height > kMostPixelsPerByte * bytes.size()) {
        refuse_jpeg(name, std::to_string(bytes.size()) + " bytes can't hold " + std::to_string(width) + " x " +
                              std::to_string(height) + " pixels");
    }
    std::vector<unsigned char> pixels(std::size_t{width} * height);
    if (!read_jpeg_rows(reader, pixels.data())) {
        refuse_jpeg(name, reader.reason.data());
    }
    return {static_cast<int>(width), static_cast<int>(height), 255, {pixels.begin(), pixels.end()}};
}

}  // namespace seampath::detail

namespace seampath {

std::string jpeg_bytes(const GreyImage& image) {
    constexpr int kQuality = 80;  // of 100: what is seen of compression begins below
    ensure(image.width > 0 && image.height > 0 && std::max(image.width, image.height) <= JPEG_MAX_DIMENSION,
           "a JPEG holds the picture");
    jpeg_compress_struct encoder{};
    jpeg_error_mgr errors{};
    encoder.err = jpeg_std_error(&errors);
    jpeg_create_compress(&encoder);
    unsigned char* bytes = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&encoder, &bytes, &size);
    encoder.image_width = static_cast<JDIMENSION>(image.width);
    encoder.image_height = static_cast<JDIMENSION>(image.height);
    encoder.input_components = 1;
    encoder.in_color_space = JCS_GRAYSCALE;
    jpeg_set_defaults(&encoder);
    jpeg_set_quality(&encoder, kQuality, TRUE);
    encoder.dct_method = JDCT_ISLOW;  // whole numbers: the same bytes on every processor
    jpeg_start_compress(&encoder, TRUE);
    std::vector<unsigned char> row(static_cast<std::size_t>(image.width));
    for (int r = 0; r < image.height; ++r) {
        for (int c = 0; c < image.width; ++c) {
            row[static_cast<std::size_t>(c)] = static_cast<unsigned char>(
                std::clamp(255 / image.white * static_cast<double>(image.at(c, r)), 0.0, 255.0));
        }
        unsigned char* line = row.data();
        jpeg_write_scanlines(&encoder, &line, 1);
    }
    jpeg_finish_compress(&encoder);
    std::string result(reinterpret_cast<const char*>(bytes), size);
    jpeg_destroy_compress(&encoder);
    std::free(bytes);
    return result;
}

}  // namespace seampath
