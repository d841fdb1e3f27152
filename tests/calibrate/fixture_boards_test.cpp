#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "datasets/picture_file.hpp"
#include "pipeline/camera_json.hpp"
#include "pipeline/fixture_calibration.hpp"
#include "stages/error.hpp"
#include "tests/optics/boards.hpp"
#include "tests/test_folder.hpp"

/// The frame of a part from boards on it, in a drawn picture.
namespace seampath {
namespace fixture_boards_test {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using testing::HasSubstr;
using Json = nlohmann::ordered_json;

class FixtureBoards : public testing::Test {
protected:
    TestFolder folder;
    const CameraModel camera = test::small_camera();
    const Isometry3d place = board_places(test::corners(), camera, 1, 30, 5).front();
    Isometry3d part_from_board = Isometry3d::Identity();
    Json nominal;

    void SetUp() override {
        part_from_board.linear() = Eigen::AngleAxisd(0.7, Vector3d(1, 2, -1).normalized()).toRotationMatrix();
        part_from_board.translation() = Vector3d(120, -40, 15);
        nominal = {{"name", "cell"},
                   {"method", "boards"},
                   {"camera", camera_json(camera)},
                   {"limit_mm", 5},
                   {"trials", 1000},
                   {"boards",
                    {{{"name", "A"},
                      {"part_from_board", pose_numbers(part_from_board)},
                      {"board", {{"kind", "chessboard"}, {"columns", 11}, {"rows", 8}, {"pitch_mm", 15}}}}}}};
    }
    FixtureCalibration calibrate(const GreyImage& image) const {
        std::ofstream(folder.path() / "seen.png", std::ios::binary) << png_bytes(image);
        std::ofstream(folder.path() / "cell.json") << nominal.dump();
        return calibrate_fixture(folder.path() / "seen.png", folder.path() / "cell.json", {});
    }
    std::string error(const GreyImage& image) const {
        try {
            calibrate(image);
            return "";
        } catch (const InputError& e) {
            return e.what();
        }
    }
};

TEST_F(FixtureBoards, GiveTheFrameWithinItsUncertainty) {
    const GreyImage image = draw_board(test::corners(), camera, place, {}, 1);
    const FrameResult r = calibrate(image).frame;
    const Isometry3d truth = place * part_from_board.inverse();
    const Vector6 d = displacement(r.base_from_part, truth);
    EXPECT_LT(d.dot(r.covariance.ldlt().solve(d)), 35) << "one in 200 000 of a chi-squared of 6";
    EXPECT_LT((r.base_from_part * Vector3d(120, -40, 15) - truth * Vector3d(120, -40, 15)).norm(), 0.5);
    EXPECT_TRUE(r.pass()) << r.faults.front();

    // The camera stands in base; a second board is not there.
    Isometry3d base = Isometry3d::Identity();
    base.linear() = Eigen::AngleAxisd(1.1, Vector3d::UnitX()).toRotationMatrix();
    base.translation() = Vector3d(500, 10, 900);
    nominal["base_from_camera"] = pose_numbers(base);
    Json other = nominal["boards"][0];
    other["name"] = "B";
    other["board"]["columns"] = 7;
    nominal["boards"].push_back(other);
    const FrameResult moved = calibrate(image).frame;
    EXPECT_LT(displacement(base * r.base_from_part, moved.base_from_part).norm(), 1e-6);
    EXPECT_THAT(moved.notes, testing::Contains(HasSubstr("not seen in the picture: B")));
}

// Markers of one dictionary on two boards are told apart by their numbers; some may be hidden.
TEST_F(FixtureBoards, OfArucoMarkersMayBeOfOneDictionaryAndHiddenInPart) {
    const Board board{BoardKind::aruco, 4, 3, 30, 22, 0, 12};
    GreyImage image = draw_board(board, camera, place, {}, 1);
    nominal["boards"][0]["board"] = {{"kind", "aruco"}, {"columns", 4},           {"rows", 3},         {"pitch_mm", 30},
                                     {"marker_mm", 22}, {"dictionary", "4x4_50"}, {"first_marker", 12}};
    Json other = nominal["boards"][0];
    other["name"] = "B";
    other["board"]["first_marker"] = 24;
    nominal["boards"].push_back(other);
    const Isometry3d truth = place * part_from_board.inverse();
    const auto off = [&](const FrameResult& r) {
        const Vector6 d = displacement(r.base_from_part, truth);
        EXPECT_LT(d.dot(r.covariance.ldlt().solve(d)), 35) << "one in 200 000 of a chi-squared of 6";
        return (r.base_from_part * Vector3d(120, -40, 15) - truth * Vector3d(120, -40, 15)).norm();
    };
    EXPECT_LT(off(calibrate(image).frame), 0.5);
    const Eigen::Vector2d second = pixel_of(camera, place * Vector3d(41, 11, 0));
    for (long row = std::lround(second.y()) - 12; row <= std::lround(second.y()) + 12; ++row) {
        for (long column = std::lround(second.x()) - 12; column <= std::lround(second.x()) + 12; ++column) {
            image.value[static_cast<std::size_t>(row * image.width + column)] = 255;
        }
    }
    EXPECT_LT(off(calibrate(image).frame), 0.6);
    nominal["boards"][1]["board"]["first_marker"] = 23;
    EXPECT_THAT(error(image), HasSubstr("/boards/1: looks like \"A\" in a picture"));
    nominal["boards"][1]["board"] = {{"kind", "aruco"}, {"columns", 1},           {"rows", 1},         {"pitch_mm", 30},
                                     {"marker_mm", 22}, {"dictionary", "4x4_50"}, {"first_marker", 40}};
    EXPECT_THAT(error(image), HasSubstr("one marker's four corners say too little"));
}

TEST_F(FixtureBoards, SayWhatTheyLack) {
    GreyImage blank = draw_board(test::corners(), camera, place, {}, 1);
    std::fill(blank.value.begin(), blank.value.end(), 128.0F);
    EXPECT_THAT(error(blank), HasSubstr("the board is not seen"));
    nominal["boards"].push_back(nominal["boards"][0]);
    nominal["boards"][1]["name"] = "B";
    EXPECT_THAT(error(blank), HasSubstr("/boards/1: looks like \"A\" in a picture"));
    nominal["boards"] = Json::array();
    EXPECT_THAT(error(blank), HasSubstr("/boards: a list of boards was needed"));
    nominal.erase("camera");
    EXPECT_THAT(error(blank), HasSubstr("/camera"));
}

}  // namespace fixture_boards_test
}  // namespace seampath
