#include "stages/picture/picture.hpp"

#include <cstdint>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/picture_file.hpp"
#include "datasets/rng.hpp"
#include "stages/error.hpp"

namespace seampath {
namespace picture_test {

using testing::HasSubstr;

GreyImage noise_picture(int width, int height, double white) {
    GreyImage image{width, height, white, {}};
    const Random random(1, 1);
    for (int i = 0; i < width * height; ++i) {
        image.value.push_back(static_cast<float>(std::floor(random.uniform(static_cast<std::uint64_t>(i)) * white)));
    }
    return image;
}

std::string picture_error(const std::string& bytes) {
    try {
        decode_picture(bytes, "a.png");
    } catch (const InputError& error) {
        return error.what();
    }
    ADD_FAILURE() << "no InputError";
    return {};
}

void put(std::string& bytes, std::size_t at, std::uint32_t number) {
    for (int i = 0; i < 4; ++i) {
        bytes[at + static_cast<std::size_t>(i)] = static_cast<char>(number >> (24 - 8 * i));
    }
}

// CRC-32 of a PNG chunk, so that a changed header is still a whole one.
std::uint32_t crc(const std::string& bytes, std::size_t begin, std::size_t end) {
    std::uint32_t c = ~0U;
    for (std::size_t i = begin; i < end; ++i) {
        c ^= static_cast<std::uint8_t>(bytes[i]);
        for (int bit = 0; bit < 8; ++bit) {
            c = (c >> 1) ^ (c & 1 ? 0xedb88320U : 0U);
        }
    }
    return ~c;
}

// The header chunk: its length at 8, name at 12, width 16, height 20, depth 24, colour type 25, checksum at 29.
std::string with_header(std::string bytes, std::size_t at, std::uint32_t number) {
    at < 24 ? put(bytes, at, number) : void(bytes[at] = static_cast<char>(number));
    put(bytes, 29, crc(bytes, 12, 29));
    return bytes;
}

TEST(Picture, ReadsBackWhatWasWritten) {
    for (const double white : {255.0, 65535.0}) {
        const GreyImage image = noise_picture(37, 11, white);
        const GreyImage read = decode_picture(png_bytes(image), "a.png");
        EXPECT_EQ(read.width, 37);
        EXPECT_EQ(read.height, 11);
        EXPECT_EQ(read.white, white);
        EXPECT_EQ(read.value, image.value);
    }
}

TEST(Picture, RefusesColourAndOtherFiles) {
    EXPECT_THAT(picture_error("P5 2 2 255 abcd"), HasSubstr("is no PNG"));
    const std::string grey = png_bytes(noise_picture(8, 8, 255));
    EXPECT_THAT(picture_error(with_header(grey, 25, 2)), HasSubstr("has 3 channels; a grey picture of one channel"));
    EXPECT_THAT(picture_error(with_header(grey, 25, 4)), HasSubstr("has 2 channels"));
}

TEST(Picture, RefusesASizeThatItsBytesCantHold) {
    const std::string grey = png_bytes(noise_picture(8, 8, 255));
    EXPECT_THAT(picture_error(with_header(with_header(grey, 16, 32000), 20, 32000)),
                HasSubstr("bytes can't hold 32000 x 32000 pixels"));
    EXPECT_THAT(picture_error(with_header(grey, 16, 1U << 30)), HasSubstr("is a damaged PNG"));
}

// Every place cut off, every byte changed: an InputError or a picture, never a crash.
TEST(Picture, SurvivesDamage) {
    const std::string whole = png_bytes(noise_picture(9, 5, 65535));
    for (std::size_t i = 0; i < whole.size(); ++i) {
        EXPECT_THAT(picture_error(whole.substr(0, i)), HasSubstr("PNG"));
        std::string bent = whole;
        bent[i] = static_cast<char>(bent[i] ^ 0x5a);
        try {
            decode_picture(bent, "a.png");
        } catch (const InputError&) {
        }
    }
}

TEST(Picture, PhotographsAreReadAsTheirBrightness) {
    GreyImage image{32, 24, 255, {}};
    for (int y = 0; y < 24; ++y) {
        for (int x = 0; x < 32; ++x) {
            image.value.push_back(static_cast<float>(40 + 3 * x + 2 * y));
        }
    }
    const std::string jpeg = jpeg_bytes(image);
    const GreyImage read = decode_photograph(jpeg, "photo");
    ASSERT_EQ(read.width, 32);
    ASSERT_EQ(read.height, 24);
    for (std::size_t i = 0; i < image.value.size(); ++i) {
        EXPECT_NEAR(read.value[i], image.value[i], 4) << i;
    }
    EXPECT_EQ(decode_photograph(png_bytes(image), "photo").value, image.value);
    EXPECT_THROW(decode_photograph(jpeg.substr(0, jpeg.size() / 2), "photo"), InputError);
    EXPECT_THROW(decode_photograph("GIF89a", "photo"), InputError);
    EXPECT_THROW(decode_picture(jpeg, "photo"), InputError) << "stripes and depths are never compressed";
}

}  // namespace picture_test
}  // namespace seampath
