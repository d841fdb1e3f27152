#include <algorithm>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/depth_picture.hpp"
#include "datasets/picture_file.hpp"
#include "datasets/stripe_sequence.hpp"
#include "pipeline/scan_input.hpp"
#include "stages/error.hpp"
#include "tests/cli/spawn.hpp"

namespace seampath {
namespace capture_test {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

void write_bytes(const fs::path& file, const std::string& bytes) {
    std::ofstream(file, std::ios::binary) << bytes;
}

// A tee of 40 pictures, made once.
const fs::path& small_capture() {
    static const TestFolder folder;
    static const fs::path file = [] {
        StripeRig rig;
        rig.images = 40;
        rig.step_mm = 1;
        return write_stripe_sequence(make_stripe_sequence({}, rig, {}, 1, 2), folder.path());
    }();
    return file;
}

// The same in a folder of its own, to be spoilt.
fs::path copy_of_capture(const TestFolder& folder) {
    fs::copy(small_capture().parent_path(), folder.path(), fs::copy_options::recursive);
    return folder.path() / "capture.json";
}

// Puts `to` in the place of the first `from`.
void edit(const fs::path& file, const std::string& from, const std::string& to) {
    std::string text = text_of(file);
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    write_bytes(file, text.replace(at, from.size(), to));
}

std::string input_error(const fs::path& file) {
    try {
        read_scan(file, {});
    } catch (const InputError& error) {
        return error.what();
    }
    ADD_FAILURE() << "no InputError";
    return {};
}

TEST(Capture, LaserStripesBecomeAScan) {
    const ScanInput input = read_scan(small_capture(), {});
    const Scan& scan = input.scan;
    EXPECT_EQ(scan.name, "capture");
    EXPECT_EQ(scan.format, "capture laser_stripe");
    EXPECT_EQ(scan.width, 640U);
    EXPECT_EQ(scan.height, 40U);
    EXPECT_GT(scan.points.size(), 15000U);
    EXPECT_EQ(scan.pixel.size(), scan.points.size());
    EXPECT_TRUE(std::is_sorted(scan.pixel.begin(), scan.pixel.end()));
    EXPECT_EQ(std::adjacent_find(scan.pixel.begin(), scan.pixel.end()), scan.pixel.end());
    EXPECT_EQ(input.sigma_mm.size(), scan.points.size());
    EXPECT_TRUE(scan.sensor_mm);
}

TEST(Capture, RunMeasuresTheSeamTwoWaysThatAgree) {
    const TestFolder out;
    const Outcome run = seampath_program({"run", small_capture(), "--out", out.path() / "run"});
    EXPECT_EQ(run.status, 0) << run.err;
    const std::string report = text_of(out.path() / "run" / "report.json");
    EXPECT_THAT(report, AllOf(HasSubstr("measured profile by profile"), Not(HasSubstr("do not agree"))));
    EXPECT_THAT(text_of(out.path() / "run" / "report.html"),
                AllOf(HasSubstr("Laser stripe, picture 21 of 40"), HasSubstr("<circle fill=\"none\"")));
    const Outcome info = seampath_program({"info", small_capture()});
    EXPECT_EQ(info.status, 0) << info.err;
    EXPECT_THAT(info.out, HasSubstr("capture laser_stripe"));
}

TEST(Capture, ItsHashIsThatOfAllPictures) {
    const TestFolder folder;
    const fs::path file = copy_of_capture(folder);
    EXPECT_EQ(scan_sha256(file), scan_sha256(small_capture()));
    fs::copy_file(folder.path() / "001.png", folder.path() / "002.png", fs::copy_options::overwrite_existing);
    EXPECT_NE(scan_sha256(file), scan_sha256(small_capture()));
}

TEST(Capture, AMissingPictureIsNamedAndTheProgramEndsWith2) {
    const TestFolder folder;
    const fs::path file = copy_of_capture(folder);
    fs::remove(folder.path() / "017.png");
    EXPECT_THAT(input_error(file), HasSubstr("capture.json: /frames/17/image: there is no picture"));
    const Outcome run = seampath_program({"run", file, "--out", folder.path() / "run"});
    EXPECT_EQ(run.status, 2);
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
}

TEST(Capture, PicturesThatDoNotFitAreRefused) {
    const TestFolder folder;
    const fs::path file = copy_of_capture(folder);
    const fs::path picture = folder.path() / "003.png";
    write_bytes(picture, png_bytes({320, 240, 255, std::vector<float>(320UL * 240, 9)}));
    EXPECT_THAT(input_error(file), HasSubstr("003.png: is 320 x 240 pixels, but its camera has 640 x 240"));
    write_bytes(picture, png_bytes({640, 240, 255, std::vector<float>(640UL * 240, 2)}));
    EXPECT_THAT(input_error(file), HasSubstr("003.png: is black: its brightest pixel is 2 of 255"));
}

TEST(Capture, WhatIsWrongInTheFileIsToldAtOnce) {
    const TestFolder folder;
    const fs::path file = copy_of_capture(folder);
    edit(file, "\"distance_mm\": ", "\"distance_mm\": 1e-9, \"tilt_deg\": ");
    edit(file, "\"size_px\"", "\"sise_px\"");
    edit(file, "\"000.png\"", "7");
    EXPECT_THAT(input_error(file),
                AllOf(HasSubstr("/laser_plane/distance_mm: the laser's plane passes the camera at 0.000 mm"),
                      HasSubstr("/laser_plane/tilt_deg: there is no such key"),
                      HasSubstr("/camera/sise_px: there is no such key; did you mean \"size_px\"?"),
                      HasSubstr("/camera/size_px: is missing"), HasSubstr("/frames/0/image: 7 is no text")));
    write_bytes(file, R"({"kind": "video"})");
    EXPECT_THAT(input_error(file), HasSubstr("/kind: \"video\" is no kind of capture"));
    write_bytes(file, R"({"kind": "depth", "camera": [], "mm_per_unit": -1, "image": "none.png"})");
    EXPECT_THAT(input_error(file),
                AllOf(HasSubstr("/camera: is []; an object was needed"), HasSubstr("/mm_per_unit: -1 is not above 0"),
                      HasSubstr("/image: there is no picture")));
}

TEST(Capture, DepthImageBecomesAScanAndOnlySixteenBitsWill) {
    const TestFolder folder;
    const CameraModel camera{320, 240, {700, 700}, {159.5, 119.5}, {}};
    const Scene scene = make_scene(resolved({}, 1));
    const DepthNoise noise;
    const GreyImage image = make_depth_picture(scene, camera, front_view(scene, 500, 40), noise, 1, 2);
    const fs::path file = folder.path() / "depth.json";
    write_bytes(folder.path() / "depth.png", png_bytes(image));
    write_bytes(file, R"({"kind": "depth", "image": "depth.png", "mm_per_unit": 0.01,
                          "camera": {"size_px": [320, 240],
                                     "matrix_px": [[700, 0, 159.5], [0, 700, 119.5], [0, 0, 1]]}})");
    const Scan scan = read_scan(file, {}).scan;
    EXPECT_EQ(scan.width, 320U);
    EXPECT_EQ(scan.points_in_file, 320U * 240U);
    EXPECT_GT(scan.points.size(), 30000U);
    EXPECT_EQ(scan.mm_per_unit, 0.01);

    write_bytes(folder.path() / "depth.png", png_bytes({320, 240, 255, std::vector<float>(320UL * 240, 100)}));
    EXPECT_THAT(input_error(file), HasSubstr("has 8 bits a pixel; a depth image of 16 was needed"));
    write_bytes(folder.path() / "depth.png", png_bytes({320, 240, 65535, std::vector<float>(320UL * 240, 0)}));
    EXPECT_THAT(input_error(file), HasSubstr("is black: no pixel has a depth"));
}

}  // namespace capture_test
}  // namespace seampath
