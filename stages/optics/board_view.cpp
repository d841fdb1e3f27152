#include "stages/optics/board_view.hpp"

#include <cmath>

#include <Eigen/Dense>
#include <opencv2/calib3d.hpp>

#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/geometry/block_fit.hpp"
#include "stages/text.hpp"

namespace seampath::optics {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

std::vector<cv::Point3f> on_board_of(const BoardView& view) {
    std::vector<cv::Point3f> points;
    for (const BoardSight& point : view.points) {
        points.emplace_back(static_cast<float>(point.on_board.x()), static_cast<float>(point.on_board.y()), 0.0F);
    }
    return points;
}

std::vector<cv::Point2f> pixels_of(const BoardView& view) {
    std::vector<cv::Point2f> points;
    for (const BoardSight& point : view.points) {
        points.emplace_back(static_cast<float>(point.pixel.x()), static_cast<float>(point.pixel.y()));
    }
    return points;
}

}  // namespace

Vector2d sight_of(const CameraModel& camera, const Isometry3d& camera_from_board, const Vector2d& on_board,
                  double circle_radius_mm) {
    const auto seen = [&](const Vector2d& p) {
        return pixel_of(camera, camera_from_board * Vector3d(p.x(), p.y(), 0));
    };
    if (circle_radius_mm <= 0) {
        return seen(on_board);
    }
    constexpr int kCorners = 12;
    Vector2d weighted(0, 0), last = seen(on_board + Vector2d(circle_radius_mm, 0));
    const Vector2d origin = last;
    double area = 0;
    for (int i = 1; i <= kCorners; ++i) {
        const double a = i * kTurn / kCorners;
        const Vector2d next = seen(on_board + circle_radius_mm * Vector2d(std::cos(a), std::sin(a)));
        const Vector2d s = last - origin, t = next - origin;
        const double cross = s.x() * t.y() - s.y() * t.x();
        area += cross;
        weighted += cross * (s + t) / 3;
        last = next;
    }
    return origin + weighted / area;
}

VectorXd residuals_of(const CameraModel& camera, const Isometry3d& camera_from_board,
                      const std::vector<BoardSight>& points, double circle_radius_mm) {
    VectorXd r(2 * static_cast<Eigen::Index>(points.size()));
    for (std::size_t i = 0; i < points.size(); ++i) {
        r.segment<2>(2 * static_cast<Eigen::Index>(i)) =
            sight_of(camera, camera_from_board, points[i].on_board, circle_radius_mm) - points[i].pixel;
    }
    return r;
}

VectorXd pose_unit() {
    VectorXd unit = VectorXd::Constant(6, 1e-2);  // mm
    unit.tail<3>() = Vector3d::Constant(1e-5);    // rad
    return unit;
}

CameraModel first_camera(const std::vector<BoardView>& views, int width, int height) {
    std::vector<std::vector<cv::Point3f>> boards;
    std::vector<std::vector<cv::Point2f>> pictures;
    for (const BoardView& view : views) {
        boards.push_back(on_board_of(view));
        pictures.push_back(pixels_of(view));
    }
    const cv::Mat K = cv::initCameraMatrix2D(boards, pictures, {width, height}, 0);
    CameraModel camera{
        width, height, {K.at<double>(0, 0), K.at<double>(1, 1)}, {0.5 * (width - 1), 0.5 * (height - 1)}, {}};
    const double size = std::max(width, height);
    // Boards square to the view say nothing of the focal length.
    if (!(camera.focal_px.minCoeff() > 0.1 * size && camera.focal_px.maxCoeff() < 100 * size)) {
        camera.focal_px.setConstant(size);
    }
    return camera;
}

Isometry3d first_place(const CameraModel& camera, const BoardView& view) {
    const cv::Matx33d K(camera.focal_px.x(), 0, camera.centre_px.x(), 0, camera.focal_px.y(), camera.centre_px.y(), 0,
                        0, 1);
    cv::Vec3d w, t;
    cv::solvePnP(on_board_of(view), pixels_of(view), K, camera.distortion, w, t);
    Isometry3d place = Isometry3d::Identity();
    place.linear() = turn_by(Vector3d(w[0], w[1], w[2])).toRotationMatrix();
    place.translation() = Vector3d(t[0], t[1], t[2]);
    return place;
}

void check_points(const BoardView& view) {
    constexpr std::size_t kLeast = 6;
    if (view.points.size() < kLeast) {
        throw InputError("board: " + view.name + ": " + std::to_string(view.points.size()) +
                         " points of the board are too few; at least 6 were needed");
    }
}

BoardPlace refined_place(const CameraModel& camera, const BoardView& view, const Isometry3d& start,
                         double circle_radius_mm, double least_variance) {
    BlockProblem problem;
    problem.blocks = 1;
    problem.shared_unit = pose_unit();
    problem.residuals = [&](std::size_t, const VectorXd& step, const VectorXd&) {
        return residuals_of(camera, displaced(start, step, start.translation()), view.points, circle_radius_mm);
    };
    const BlockFit fit = fit_blocks(problem, VectorXd::Zero(6), {VectorXd()});
    BoardPlace place;
    place.camera_from_board = displaced(start, fit.shared, start.translation());
    place.covariance = std::max(least_variance, fit.variance_factor()) * fit.covariance();
    place.rms_px = std::sqrt(fit.chi2 / static_cast<double>(view.points.size()));
    return place;
}

}  // namespace seampath::optics

namespace seampath {

BoardPlace locate_board(const CameraModel& camera, const BoardView& view, double circle_radius_mm) {
    optics::check_points(view);
    return optics::refined_place(camera, view, optics::first_place(camera, view), circle_radius_mm);
}

BoardPlace locate_plane(const CameraModel& camera, const BoardView& points) {
    constexpr std::size_t kLeast = 4;
    constexpr double kThinnest = 0.02;  // breadth of the points over their length
    constexpr double kReading = 1;      // px, 1-sigma
    constexpr double kMostOff = 0.01;   // of the picture's width
    const std::string who = "photo: " + points.name + ": ";
    if (points.points.size() < kLeast) {
        throw InputError(who + std::to_string(points.points.size()) +
                         " points of the plane are too few; 4 or more were needed");
    }
    Eigen::Vector2d middle(0, 0);
    for (const BoardSight& point : points.points) {
        middle += point.on_board / static_cast<double>(points.points.size());
    }
    Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
    for (const BoardSight& point : points.points) {
        spread += (point.on_board - middle) * (point.on_board - middle).transpose();
    }
    const Eigen::Vector2d variances = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread).eigenvalues();
    if (!(variances[0] > kThinnest * kThinnest * variances[1])) {
        throw InputError(who + "the points of the plane lie on one line; take them from the corners of an area");
    }
    BoardPlace place =
        optics::refined_place(camera, points, optics::first_place(camera, points), 0, kReading * kReading);
    if (!(place.rms_px <= kMostOff * camera.width)) {
        throw InputError(who + "the points of the plane are " + fixed(place.rms_px, 1) +
                         " px from where one plane would show them; check their order, their pixels and millimetres");
    }
    return place;
}

}  // namespace seampath
