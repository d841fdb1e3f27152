#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "datasets/picture_file.hpp"
#include "datasets/stripe_picture.hpp"
#include "pipeline/camera_json.hpp"
#include "pipeline/capture_file.hpp"
#include "tests/cli/spawn.hpp"
#include "tests/optics/boards.hpp"

/// `calibrate camera` and `laser` as a user calls them, on rendered pictures.
namespace seampath {
namespace optics_cli_test {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;
using Json = nlohmann::ordered_json;

class OpticsCli : public testing::Test {
protected:
    TestFolder folder;
    const CameraModel camera = test::small_camera();
    const Json board{{"kind", "chessboard"}, {"columns", 11}, {"rows", 8}, {"pitch_mm", 15}};

    void write(const std::string& name, const std::string& bytes) const {
        std::ofstream(folder.path() / name, std::ios::binary) << bytes;
    }
    Outcome calibrate(const std::string& what, const std::string& file) const {
        return seampath_program(
            {"calibrate", what, folder.path() / file, "--out", folder.path() / what, "--date", "2026-11-26T05:00:00Z"});
    }
    Json result(const std::string& what) const { return Json::parse(text_of(folder.path() / what / "result.json")); }
    std::string error(const std::string& what, const Json& file) const {
        write("bad.json", file.dump());
        const Outcome run = calibrate(what, "bad.json");
        EXPECT_EQ(run.status, 2) << run.err << run.out;
        EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
        return run.err;
    }
};

TEST_F(OpticsCli, RenderedBoardsGiveTheCamera) {
    Json images = Json::array();
    int number = 0;
    for (const auto& place : board_places(test::corners(), camera, 6, 40, 3)) {
        images.push_back(std::to_string(++number) + ".png");
        write(images.back(), png_bytes(draw_board(test::corners(), camera, place, {}, 1)));
    }
    write("views.json", Json{{"name", "top"}, {"limit_percent", 0.2}, {"board", board}, {"images", images}}.dump());
    const Outcome run = calibrate("camera", "views.json");
    EXPECT_THAT(run.out, AllOf(HasSubstr("fx_px"), HasSubstr("in views held out"))) << run.err;
    const Json json = result("camera");
    const double fx = json.at("camera").at("matrix_px")[0][0].get<double>();
    EXPECT_NEAR(fx / camera.focal_px.x(), 1, 0.002);
    EXPECT_LT(json.at("rms_px").get<double>(), 0.15);
    EXPECT_EQ(json.at("views").size(), 6u);
    EXPECT_EQ(json.at("residual_map").size(), 6u);
}

TEST_F(OpticsCli, LinesOnBoardsGiveThePlaneOfACaptureFile) {
    const Plane truth{Vector3d(0, 0, 330), Vector3d(0, std::cos(0.44), -std::sin(0.44))};
    Json views = Json::array();
    for (int i = 0; i < 3; ++i) {
        Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
        place.linear() = turn_by(Vector3d(0.1 * i - 0.15, 0.3 - 0.2 * i, 0.05)).toRotationMatrix();
        place.translation() = Vector3d(-75, -52, 295 + 35.0 * i);
        const std::string n = std::to_string(i);
        write("b" + n + ".png", png_bytes(draw_board(test::corners(), camera, place, {}, 1)));
        StripePicture picture;
        picture.width = camera.width;
        picture.height = camera.height;
        picture.courses = {line_on_board(test::corners(), camera, place, truth)};
        write("s" + n + ".png", png_bytes(draw_stripes(picture, {}, 7)));
        views.push_back({{"board", "b" + n + ".png"}, {"stripe", "s" + n + ".png"}});
    }
    const Json file{{"name", "line"}, {"board", board}, {"camera", camera_json(camera)}, {"views", views}};
    write("lines.json", file.dump());
    const Outcome run = calibrate("laser", "lines.json");
    EXPECT_EQ(run.status, 0) << run.err << run.out;
    const Json json = result("laser");
    EXPECT_LT(json.at("expanded_uncertainty_mm").get<double>(), 0.05);
    // The result's keys are those of a capture file.
    write("capture.json", Json{{"kind", "laser_stripe"},
                               {"camera", json.at("camera")},
                               {"laser_plane", json.at("laser_plane")},
                               {"frames", {{{"image", "s0.png"}, {"base_from_camera", {0, 0, 0, 1, 0, 0, 0}}}}}}
                              .dump());
    const auto capture = std::get<StripeCapture>(read_capture(folder.path() / "capture.json"));
    for (const Vector3d& p : {Vector3d(0, 0, 330), Vector3d(70, 20, 330 + 20 / std::tan(0.44))}) {
        EXPECT_NEAR(std::abs(capture.plane.normal.dot(p) - capture.plane.distance_mm), 0, 0.05);
    }
    EXPECT_THAT(error("laser", Json{{"name", "line"},
                                    {"board", board},
                                    {"camera", camera_json(camera)},
                                    {"views", {{{"board", "s0.png"}, {"stripe", "s0.png"}}}}}),
                HasSubstr("s0.png: the board is not seen"));
    EXPECT_THAT(error("laser", Json{{"name", "line"}, {"board", board}, {"camera", "lines.json"}, {"views", views}}),
                HasSubstr("is no result of a camera's calibration"));
}

TEST_F(OpticsCli, HandEyeTakesPicturesOfTheBoard) {
    Eigen::Isometry3d flange_from_camera = Eigen::Isometry3d::Identity(), base_from_board = flange_from_camera;
    flange_from_camera.linear() = turn_by(Vector3d(0.1, -0.2, 1.5)).toRotationMatrix();
    flange_from_camera.translation() = Vector3d(40, -25, 90);
    base_from_board.translation() = Vector3d(800, 100, 50);
    Json poses = Json::array();
    for (const auto& place : board_places(test::corners(), camera, 5, 40, 3)) {
        const std::string image = "h" + std::to_string(poses.size()) + ".png";
        write(image, png_bytes(draw_board(test::corners(), camera, place, {}, 1)));
        poses.push_back({{"image", image},
                         {"base_from_flange", pose_numbers(base_from_board * (flange_from_camera * place).inverse())}});
    }
    const Json file{
        {"name", "eye"},  {"sensor", "camera"}, {"mount", "on-arm"}, {"limit_mm", 1}, {"camera", camera_json(camera)},
        {"board", board}, {"poses", poses}};
    write("eye.json", file.dump());
    const Outcome run = calibrate("hand-eye", "eye.json");
    EXPECT_EQ(run.status, 0) << run.err << run.out;
    const Json json = result("hand-eye");
    const auto p = json.at("flange_from_camera").at("position_mm").get<std::vector<double>>();
    EXPECT_LT((Vector3d(p[0], p[1], p[2]) - flange_from_camera.translation()).norm(), 0.5);
    EXPECT_EQ(json.at("inputs").size(), 6u);
}

TEST_F(OpticsCli, BadInputIsOneClearLineEach) {
    const auto views = [&](Json changed, Json images = Json::array({"a.png"})) {
        return Json{{"name", "top"}, {"board", std::move(changed)}, {"images", std::move(images)}};
    };
    write("a.png", png_bytes({64, 48, 255, std::vector<float>(std::size_t{64} * 48, 9)}));
    write("b.png", png_bytes({48, 48, 255, std::vector<float>(std::size_t{48} * 48, 9)}));
    Json changed = board;
    changed["kind"] = "chesboard";
    EXPECT_THAT(error("camera", views(changed)), HasSubstr("did you mean \"chessboard\"?"));
    changed = board;
    changed["rows"] = 1.5;
    EXPECT_THAT(error("camera", views(changed)), HasSubstr("/board/rows: 1.5 is no whole number"));
    changed = board;
    changed["marker_mm"] = 3;
    EXPECT_THAT(error("camera", views(changed)), HasSubstr("does not belong to a board of this kind"));
    EXPECT_THAT(error("camera", views(board)), HasSubstr("the board was found in 0 views"));
    EXPECT_THAT(error("camera", views(board, {"a.png", "b.png"})), HasSubstr("nothing is resized"));
    EXPECT_THAT(error("camera", views(board, {"c.png"})), HasSubstr("c.png"));
}

}  // namespace optics_cli_test
}  // namespace seampath
