#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/photo_picture.hpp"
#include "pipeline/run.hpp"
#include "pipeline/scan_input.hpp"
#include "stages/error.hpp"
#include "stages/picture/picture.hpp"
#include "tests/test_folder.hpp"

namespace seampath {
namespace photo_run_test {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::HasSubstr;

// 0.25 mm a pixel, straight from above: pixel (c, r) lies at (0.25 c, -0.25 r) of the plane.
constexpr double kMmPerPx = 0.25;
constexpr const char* kCamera =
    R"("camera": {"size_px": [640, 480], "matrix_px": [[2000, 0, 0], [0, 2000, 0], [0, 0, 1]]})";
constexpr const char* kFromAbove = "[0, 0, 500, 0, 1, 0, 0]";

const PhotoPicture& joint() {
    static const PhotoPicture picture = [] {
        PhotoPicture made;
        made.course = {{-5, 200}, {645, 260}};
        return made;
    }();
    return picture;
}

// With a pose, or with points of the plane.
fs::path write_capture(const fs::path& folder, const GreyImage& image, const std::string& plane,
                       const std::string& key = "camera_from_plane") {
    std::ofstream(folder / "joint.jpg", std::ios::binary) << jpeg_bytes(image);
    std::ofstream(folder / "capture.json")
        << "{\"kind\": \"photo\", " << kCamera << ", \"image\": \"joint.jpg\", \"" << key << "\": " << plane << "}";
    return folder / "capture.json";
}

const GreyImage& photograph() {
    static const GreyImage image = [] {
        PhotoNoise noise;
        noise.tacks = 2;
        return draw_photo(joint(), noise, 5);
    }();
    return image;
}

double off_joint_mm(const Vector3d& p) {
    const Vector2d a = joint().course.front(), along = (joint().course.back() - a).normalized();
    const Vector2d from = Vector2d(p.x(), -p.y()) / kMmPerPx - a;
    return kMmPerPx * std::abs(along.x() * from.y() - along.y() * from.x());
}

TEST(PhotoRun, AJointIsWeldedWhereThePhotographShowsIt) {
    const TestFolder folder;
    Config config;
    config.validate.tolerance_mm = 0.25;  // a pixel
    const PartResult part =
        run_part(write_capture(folder.path(), photograph(), kFromAbove), folder.path() / "out", config);
    ASSERT_EQ(part.models.size(), 1U);
    EXPECT_EQ(part.models[0].kind, JointKind::butt);
    EXPECT_TRUE(part.pass()) << part.deviations[0].verdict;
    EXPECT_GT(part.models[0].length_mm, 0.95 * kMmPerPx * 640);
    EXPECT_GT(part.deviations[0].coverage, 0.8);
    int welds = 0;
    for (const Waypoint& waypoint : part.plan.waypoints) {
        if (waypoint.kind == WaypointKind::weld_start || waypoint.kind == WaypointKind::weld ||
            waypoint.kind == WaypointKind::weld_end) {
            EXPECT_LT(off_joint_mm(waypoint.p), 0.5 * kMmPerPx);
            EXPECT_LT((waypoint.q * Vector3d::UnitZ()).z(), -0.99) << "the torch comes from the camera's side";
            ++welds;
        }
    }
    EXPECT_GT(welds, 1);
    std::ifstream page(folder.path() / "out" / "report.html");
    const std::string html{std::istreambuf_iterator<char>(page), {}};
    EXPECT_THAT(html, HasSubstr("data:image/jpeg;base64,"));
    EXPECT_LT(html.size(), 4U << 20);
}

// The verdict is the picture's: a model beside the line does not pass, and one on a picture without a line neither.
TEST(PhotoRun, AModelBesideTheLineFails) {
    const PhotoView view{draw_photo(joint(), {}, 5),
                         {640, 480, {2000, 2000}, {0, 0}, {}},
                         Eigen::Translation3d(0, 0, 500) * Eigen::AngleAxisd(std::acos(-1), Vector3d::UnitX())};
    const auto model_at = [](double off_px) {
        SeamModel model;
        model.kind = JointKind::butt;
        const auto on_plane = [&](const Vector2d& p) {
            return Vector3d(kMmPerPx * p.x(), -kMmPerPx * (p.y() + off_px), 0);
        };
        const Vector3d a = on_plane({20, 202.3}), b = on_plane({620, 257.7});
        model.length_mm = (b - a).norm();
        model.curve = {false,
                       {0, 0, 0, 0, model.length_mm, model.length_mm, model.length_mm, model.length_mm},
                       {a, a + (b - a) / 3, a + (b - a) * (2.0 / 3), b}};
        for (const double station : {0.0, model.length_mm}) {
            model.flanks.push_back({station, Vector3d::UnitZ(), Vector3d::UnitZ(), 0.05});
        }
        return model;
    };
    ValidateOptions options;
    options.tolerance_mm = 0.25;
    const Deviation on = validate(model_at(0), view, options), beside = validate(model_at(4), view, options);
    EXPECT_TRUE(on.pass) << on.verdict;
    EXPECT_FALSE(beside.pass) << beside.verdict;
    EXPECT_NEAR(beside.p50_mm, 4 * kMmPerPx, 0.15);
    PhotoView bare = view;
    std::fill(bare.image.value.begin(), bare.image.value.end(), 100.0F);
    const Deviation nothing = validate(model_at(0), bare, options);
    EXPECT_FALSE(nothing.pass) << nothing.verdict;
    EXPECT_EQ(nothing.coverage, 0);
}

// Four points read off the picture stand for the pose; a pixel that is read wrong by d moves the plane by 0.25 d mm
// there, so the seam is known to about that.
TEST(PhotoRun, FourPointsOfThePlaneStandForThePose) {
    const TestFolder folder;
    const std::string points = R"([{"pixel_px": [40, 40], "plane_mm": [10, -10]},
        {"pixel_px": [600, 40], "plane_mm": [150, -10]}, {"pixel_px": [600, 440], "plane_mm": [150, -110]},
        {"pixel_px": [40, 440], "plane_mm": [10, -110]}])";
    const auto seam_of = [&](const std::string& text) {
        const ScanInput input = read_scan(write_capture(folder.path(), photograph(), text, "plane_points"), {});
        return extract_photo(*input.photo, JointChoice::automatic).seams.at(0);
    };
    const ScanInput posed = read_scan(write_capture(folder.path(), photograph(), kFromAbove), {});
    const Seam by_pose = extract_photo(*posed.photo, JointChoice::automatic).seams.at(0), by_points = seam_of(points);
    ASSERT_EQ(by_points.points.size(), by_pose.points.size());
    for (std::size_t i = 0; i < by_pose.points.size(); ++i) {
        EXPECT_LT((by_points.points[i].p - by_pose.points[i].p).norm(), 1e-4);
        EXPECT_GT(by_points.points[i].sigma_mm, by_pose.points[i].sigma_mm + 0.05) << "a reading is good to a pixel";
        EXPECT_LT(by_points.points[i].sigma_mm, by_pose.points[i].sigma_mm + 0.4);
    }
    const auto error_of = [&](const std::string& from, const std::string& to) {
        std::string text = points;
        text.replace(text.find(from), from.size(), to);
        try {
            seam_of(text);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string("none");
    };
    EXPECT_THAT(error_of("[10, -110]", "[110, -10]"), HasSubstr("px from where one plane would show them"));
    EXPECT_THAT(error_of(R"({"pixel_px": [40, 40], "plane_mm": [10, -10]},)", ""), HasSubstr("4 or more"));
    EXPECT_THAT(error_of("\"plane_mm\": [10, -10]", "\"plane\": [10, -10]"), HasSubstr("/plane_points/0"));
    EXPECT_THAT(error_of("[150, -110]}", "[150, -10.1]}"), HasSubstr("px from where"));
}

TEST(PhotoRun, BadInputGetsOneClearLine) {
    const TestFolder folder;
    const auto error_of = [&](const GreyImage& image, const std::string& pose) {
        try {
            read_scan(write_capture(folder.path(), image, pose), {});
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string("none");
    };
    GreyImage black = photograph(), small{320, 240, 255, std::vector<float>(std::size_t{320} * 240, 100)};
    std::fill(black.value.begin(), black.value.end(), 1.0F);
    EXPECT_THAT(error_of(black, kFromAbove), HasSubstr("is black"));
    EXPECT_THAT(error_of(small, kFromAbove), HasSubstr("is 320 x 240 pixels, but its camera has 640 x 480"));
    EXPECT_THAT(error_of(photograph(), "[0, 0, 500, 0.7071068, 0.7071068, 0, 0]"), HasSubstr("seen edge-on"));
    EXPECT_THAT(error_of(photograph(), "[0, 0, -500, 0, 1, 0, 0]"), HasSubstr("not before the camera"));
    EXPECT_THAT(error_of(photograph(), "[0, 0, 500, 0, 2, 0, 0]"), HasSubstr("/camera_from_plane"));
    const ScanInput input = read_scan(write_capture(folder.path(), photograph(), kFromAbove), {});
    ASSERT_TRUE(input.photo);
    EXPECT_THROW(extract_photo(*input.photo, JointChoice::fillet), InputError);
    fs::remove(folder.path() / "joint.jpg");
    EXPECT_THROW(read_scan(folder.path() / "capture.json", {}), InputError);
}

}  // namespace photo_run_test
}  // namespace seampath
