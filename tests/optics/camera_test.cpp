#include <Eigen/Dense>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "datasets/fixtures/board_pictures.hpp"
#include "stages/angle.hpp"
#include "stages/board/board.hpp"
#include "stages/error.hpp"
#include "stages/optics/optics.hpp"
#include "tests/optics/boards.hpp"

/// Cameras from boards with known truth.
namespace seampath {
namespace camera_test {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

std::vector<BoardView> views_of(const CameraModel& camera, int count, double tilt_deg, double sigma_px,
                                std::uint64_t seed) {
    std::vector<BoardView> views;
    for (const Isometry3d& place : board_places(test::corners(), camera, count, tilt_deg, seed)) {
        views.push_back(test::seen(test::corners(), camera, place, sigma_px, seed * 100 + views.size()));
        views.back().name = "view " + std::to_string(views.size());
    }
    return views;
}

CameraOptions options_of(const CameraModel& camera) {
    return {camera.width, camera.height, 0, 0.1};
}

TEST(CalibrateCamera, ExactCornersGiveTheCamera) {
    const CameraModel truth = test::wide_camera();
    const CameraCalibration r = calibrate_camera(views_of(truth, 8, 35, 0, 1), options_of(truth));
    EXPECT_LT((r.camera.focal_px - truth.focal_px).norm(), 1e-4);
    EXPECT_LT((r.camera.centre_px - truth.centre_px).norm(), 1e-4);
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_NEAR(r.camera.distortion[i], truth.distortion[i], 1e-5);
    }
    EXPECT_TRUE(r.pass()) << r.faults.front();
}

TEST(CalibrateCamera, NoiseOfAFifthOfAPixelLeavesTheFocalLengthSure) {
    const CameraModel truth = test::wide_camera();
    double squares = 0, in_sigmas = 0, held_out = 0;
    constexpr int kSets = 8;
    for (std::uint64_t seed = 1; seed <= kSets; ++seed) {
        const CameraCalibration r = calibrate_camera(views_of(truth, 25, 45, 0.2, seed), options_of(truth));
        const Vector2d error = (r.camera.focal_px - truth.focal_px).cwiseQuotient(truth.focal_px);
        squares += error.squaredNorm() / 2;
        const Eigen::Vector4d e(r.camera.focal_px.x() - truth.focal_px.x(), r.camera.focal_px.y() - truth.focal_px.y(),
                                r.camera.centre_px.x() - truth.centre_px.x(),
                                r.camera.centre_px.y() - truth.centre_px.y());
        in_sigmas += e.dot(r.covariance.topLeftCorner<4, 4>().ldlt().solve(e)) / 4;
        held_out += r.held_out_px / kSets;
        EXPECT_NEAR(r.sigma_px, 0.2, 0.01);
        EXPECT_GT(r.held_out_px, r.rms_px);
    }
    std::cout << "focal length: rms error " << 100 * std::sqrt(squares / kSets) << " %; chi-squared of fx, fy, cx, cy "
              << in_sigmas / kSets << "; held out " << held_out << " px\n";
    EXPECT_LE(std::sqrt(squares / kSets), 0.0005);
    EXPECT_NEAR(in_sigmas / kSets, 1, 3 * std::sqrt(2.0 / (4 * kSets)));  // 3 sigma of a chi-squared of 32
}

TEST(CalibrateCamera, AgreesWithOpenCv) {
    const CameraModel truth = test::wide_camera();
    const auto views = views_of(truth, 12, 35, 0.2, 7);
    const CameraCalibration r = calibrate_camera(views, options_of(truth));
    std::vector<std::vector<cv::Point3f>> boards;
    std::vector<std::vector<cv::Point2f>> pixels;
    for (const BoardView& view : views) {
        boards.emplace_back();
        pixels.emplace_back();
        for (const BoardSight& p : view.points) {
            boards.back().emplace_back(static_cast<float>(p.on_board.x()), static_cast<float>(p.on_board.y()), 0.0F);
            pixels.back().emplace_back(static_cast<float>(p.pixel.x()), static_cast<float>(p.pixel.y()));
        }
    }
    cv::Mat K, d, inner, outer, per_view;
    std::vector<cv::Mat> w, t;
    cv::calibrateCamera(boards, pixels, {truth.width, truth.height}, K, d, w, t, inner, outer, per_view,
                        r.camera.distortion[4] == 0 ? cv::CALIB_FIX_K3 : 0);
    EXPECT_NEAR(r.camera.focal_px.x(), K.at<double>(0, 0), 0.02);
    EXPECT_NEAR(r.camera.centre_px.y(), K.at<double>(1, 2), 0.02);
    EXPECT_NEAR(r.camera.distortion[0], d.at<double>(0), 1e-4);
    // Its variance factor counts the points, and not their two coordinates each.
    const double points = 12 * 88, unknowns = 8 + 12 * 6;
    const double counted = std::sqrt((points - unknowns) / (2 * points - unknowns));
    EXPECT_NEAR(std::sqrt(r.covariance(0, 0)) / inner.at<double>(0), counted, 0.02);
}

TEST(CalibrateCamera, PoorSetsSayWhatIsMissing) {
    const CameraModel truth = test::wide_camera();
    const CameraCalibration flat = calibrate_camera(views_of(truth, 10, 4, 0.2, 1), options_of(truth));
    EXPECT_THAT(flat.faults, Contains(HasSubstr("no view is tilted by more than")));
    const CameraCalibration few = calibrate_camera(views_of(truth, 3, 35, 0.2, 1), options_of(truth));
    EXPECT_THAT(few.faults, Contains(HasSubstr("3 views are too few")));
    auto left = views_of(truth, 16, 35, 0.2, 1);
    for (BoardView& view : left) {
        std::erase_if(view.points, [](const BoardSight& p) { return p.pixel.x() > 800; });
    }
    std::erase_if(left, [](const BoardView& view) { return view.points.size() < 12; });
    EXPECT_THAT(calibrate_camera(left, options_of(truth)).faults,
                Contains(AllOf(HasSubstr("upper right"), HasSubstr("lower right"))));
    EXPECT_THROW(calibrate_camera({left[0], left[1]}, options_of(truth)), InputError);
}

TEST(CalibrateCamera, CornersFoundInTheWrongPlaceAreDropped) {
    const CameraModel truth = test::wide_camera();
    auto views = views_of(truth, 12, 35, 0.2, 3);
    views[4].points[17].pixel += Vector2d(6, -3);
    views[9].points[2].pixel += Vector2d(0, 4);
    const CameraCalibration r = calibrate_camera(views, options_of(truth));
    EXPECT_EQ(r.views[4].dropped, 1);
    EXPECT_EQ(r.views[9].dropped, 1);
    EXPECT_LT((r.camera.focal_px - truth.focal_px).norm(), 2);
}

TEST(LocateBoard, ItsCovarianceIsTrue) {
    const CameraModel camera = test::small_camera();
    const Isometry3d place = board_places(test::corners(), camera, 1, 35, 5).front();
    double chi2 = 0;
    constexpr int kSets = 200;
    for (std::uint64_t seed = 1; seed <= kSets; ++seed) {
        const BoardPlace found = locate_board(camera, test::seen(test::corners(), camera, place, 0.1, seed), 0);
        const Vector6 d = displacement(place, found.camera_from_board);
        chi2 += d.dot(Matrix6(found.covariance).ldlt().solve(d)) / 6;
    }
    EXPECT_NEAR(chi2 / kSets, 1, 0.15);
}

// In pictures: points against their projection; a circle's middle is that of its image.
TEST(FindBoard, EveryKindIsFoundToAFractionOfAPixel) {
    const CameraModel camera = test::small_camera();
    const std::vector<Board> boards{test::corners(),
                                    {BoardKind::charuco, 9, 6, 20, 15, 0},
                                    {BoardKind::circles, 4, 9, 12, 9, 0},
                                    {BoardKind::aruco, 5, 4, 30, 22, 0, 7}};
    for (const Board& board : boards) {
        double squares = 0;
        std::size_t count = 0;
        for (const Isometry3d& place : board_places(board, camera, 1, 30, 9)) {
            const auto found = find_board(draw_board(board, camera, place, {}, 1), board);
            EXPECT_EQ(found.size(), points_of(board).size()) << kBoardKindNames[static_cast<std::size_t>(board.kind)];
            BoardView view{"", {}};
            for (const SeenPoint& p : found) {
                view.points.push_back({p.on_board, p.pixel});
            }
            const bool round = board.kind == BoardKind::circles;
            if (view.points.size() < 6) {
                continue;
            }
            const BoardPlace located = locate_board(camera, view, round ? board.size_mm / 2 : 0);
            squares += located.rms_px * located.rms_px * static_cast<double>(found.size());
            count += found.size();
            EXPECT_LT(displacement(place, located.camera_from_board).head<3>().norm(), 0.3)
                << kBoardKindNames[static_cast<std::size_t>(board.kind)];
        }
        std::cout << kBoardKindNames[static_cast<std::size_t>(board.kind)] << ": "
                  << std::sqrt(squares / static_cast<double>(count)) << " px\n";
        EXPECT_LE(std::sqrt(squares / static_cast<double>(count)), 0.1);
    }
    EXPECT_TRUE(find_board({640, 480, 255, std::vector<float>(std::size_t{640} * 480, 20)}, test::corners()).empty());
}

}  // namespace camera_test
}  // namespace seampath
