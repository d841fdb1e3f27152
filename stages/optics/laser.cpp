#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Dense>

#include "stages/error.hpp"
#include "stages/geometry/block_fit.hpp"
#include "stages/geometry/least_squares.hpp"
#include "stages/optics/board_view.hpp"
#include "stages/optics/optics.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

/// Where the ray of a pixel meets the board's plane; empty where it does not, before the camera.
std::optional<Vector3d> on_board(const CameraModel& camera, const Isometry3d& camera_from_board,
                                 const Vector2d& pixel) {
    const auto direction = direction_of(camera, pixel);
    const Vector3d normal = camera_from_board.linear().col(2);
    const double t = direction ? normal.dot(camera_from_board.translation()) / normal.dot(*direction) : -1;
    return t > 0 ? std::optional<Vector3d>(t * *direction) : std::nullopt;
}

/// The points of a view whose rays meet its board.
struct LitBoard {
    std::string name;
    Isometry3d place;
    Eigen::LLT<MatrixXd> place_noise;
    std::vector<LitPoint> lit;
    std::vector<Vector3d> points;  ///< mm, the board as it was located
};

LitBoard lit_board(const CameraModel& camera, const LitView& view) {
    LitBoard board{
        view.name, view.board.camera_from_board, Eigen::LLT<MatrixXd>(MatrixXd(view.board.covariance)), {}, {}};
    for (const LitPoint& lit : view.points) {
        if (const auto p = on_board(camera, board.place, lit.pixel)) {
            board.lit.push_back(lit);
            board.points.push_back(*p);
        }
    }
    return board;
}

/// The plane about which parameters are steps: turns about u and v through a point, and a shift along the normal.
struct PlaneFrame {
    Vector3d point, normal, u, v;

    Plane moved(const VectorXd& step) const {
        const Vector3d n = turn_by(step[0] * u + step[1] * v) * normal;
        return {point + step[2] * normal, n};
    }
};

PlaneFrame frame_of(const Plane& plane) {
    const Vector3d u = plane.normal.unitOrthogonal();
    return {plane.point, plane.normal, u, plane.normal.cross(u)};
}

/// How far a point leaves the plane for a pixel across the line: what its sigma is in mm.
double mm_per_pixel(const CameraModel& camera, const LitBoard& board, std::size_t i, const Vector3d& normal) {
    constexpr double kStep = 0.1;  // px
    const Vector2d off = kStep * board.lit[i].normal;
    const auto a = on_board(camera, board.place, board.lit[i].pixel - off);
    const auto b = on_board(camera, board.place, board.lit[i].pixel + off);
    return a && b ? std::abs(normal.dot(*b - *a)) / (2 * kStep) : INFINITY;
}

BlockFit fit_plane(const CameraModel& camera, const std::vector<LitBoard>& boards, const PlaneFrame& frame) {
    std::vector<std::vector<double>> sigma(boards.size());
    for (std::size_t k = 0; k < boards.size(); ++k) {
        for (std::size_t i = 0; i < boards[k].points.size(); ++i) {
            sigma[k].push_back(boards[k].lit[i].sigma_px * mm_per_pixel(camera, boards[k], i, frame.normal));
        }
    }
    BlockProblem problem;
    problem.blocks = boards.size();
    problem.shared_unit = Vector3d(1e-5, 1e-5, 1e-3);  // rad, rad, mm
    problem.own_unit = optics::pose_unit();
    problem.residuals = [&](std::size_t k, const VectorXd& step, const VectorXd& board_step) {
        const LitBoard& board = boards[k];
        const Plane plane = frame.moved(step);
        const Isometry3d place = displaced(board.place, board_step, board.place.translation());
        const Vector3d normal = place.linear().col(2);
        const double distance = normal.dot(place.translation());
        VectorXd r(6 + static_cast<Index>(board.points.size()));
        r.head<6>() = board.place_noise.matrixL().solve(board_step);
        for (std::size_t i = 0; i < board.points.size(); ++i) {
            // The ray is that of the point as first seen, met by the board where it is now.
            const Vector3d& ray = board.points[i];
            r[6 + static_cast<Index>(i)] = signed_distance(plane, distance / normal.dot(ray) * ray) / sigma[k][i];
        }
        return r;
    };
    return fit_blocks(problem, VectorXd::Zero(3), std::vector<VectorXd>(boards.size(), VectorXd::Zero(6)));
}

/// Largest 1.96 sigma of the plane along its normal over the corners of what was lit.
double largest_error(const LaserCalibration& laser, const std::vector<LitBoard>& boards) {
    Eigen::AlignedBox2d area;
    for (const LitBoard& board : boards) {
        for (const Vector3d& p : board.points) {
            area.extend(Vector2d((p - laser.plane.point).dot(laser.u), (p - laser.plane.point).dot(laser.v)));
        }
    }
    double largest = 0;
    for (int k = 0; k < 4; ++k) {
        const Vector2d at = area.corner(static_cast<Eigen::AlignedBox2d::CornerType>(k));
        const Vector3d J(at.y(), -at.x(), 1);  // a turn about u lifts v, one about v lowers u
        largest = std::max(largest, 1.96 * std::sqrt(J.dot(laser.covariance * J)));
    }
    return largest;
}

void add_lit_views(const std::vector<LitBoard>& boards, const PlaneFrame& frame, const BlockFit& fit,
                   LaserCalibration& result) {
    double squares = 0, points = 0;
    result.nearest_mm = INFINITY;
    for (std::size_t k = 0; k < boards.size(); ++k) {
        LitViewResult view{boards[k].name, static_cast<int>(boards[k].points.size()), 0, 0};
        const Plane without = frame.moved(fit.shared + without_block(fit, k).step);
        double own = 0;
        for (const Vector3d& p : boards[k].points) {
            own += std::pow(signed_distance(result.plane, p), 2);
            view.held_out_mm += signed_distance(without, p) / view.points;
            result.nearest_mm = std::min(result.nearest_mm, p.z());
            result.furthest_mm = std::max(result.furthest_mm, p.z());
        }
        view.rms_mm = std::sqrt(own / view.points);
        squares += own;
        points += view.points;
        result.views.push_back(view);
    }
    result.rms_mm = std::sqrt(squares / points);
}

void judge_laser(double limit_mm, bool converged, LaserCalibration& result) {
    constexpr std::size_t kFewLines = 3;
    constexpr double kFlat = 0.05;  // of the depth: a working depth that is hardly one
    if (!converged) {
        result.faults.emplace_back("the least squares did not converge; check the camera and the board's dimensions");
    }
    if (result.views.size() < kFewLines) {
        result.faults.push_back(std::to_string(result.views.size()) +
                                " views leave nothing to check the plane with; take 5 or more");
    }
    if (result.furthest_mm - result.nearest_mm < kFlat * result.furthest_mm) {
        result.faults.push_back("the board was seen between " + fixed(result.nearest_mm, 1) + " and " +
                                fixed(result.furthest_mm, 1) +
                                " mm only; move it over the whole depth in which parts will lie");
    }
    if (!(result.expanded_mm <= limit_mm)) {
        result.faults.push_back("the plane is known to " + fixed(result.expanded_mm, 4) +
                                " mm only where the laser was seen; the limit is " + shortest(limit_mm) +
                                " mm; take more views, at more depths");
    }
}

}  // namespace

LaserCalibration calibrate_laser(const CameraModel& camera, const std::vector<LitView>& views, double limit_mm) {
    constexpr std::size_t kLeastLines = 2;
    if (views.size() < kLeastLines) {
        throw InputError("laser: " + std::to_string(views.size()) +
                         " views of its line on a board are too few; at least 2, better 5 or more, at different depths "
                         "were needed");
    }
    std::vector<LitBoard> boards;
    std::vector<Vector3d> all;
    for (const LitView& view : views) {
        boards.push_back(lit_board(camera, view));
        if (boards.back().points.empty()) {
            throw InputError("laser: " + view.name + ": the laser's line is not on the board; check the pictures");
        }
        all.insert(all.end(), boards.back().points.begin(), boards.back().points.end());
    }
    // Two lines make a plane; the spread across the longer one must be more than the lines' own errors.
    constexpr double kOneLine = 1e-3;
    const Associated<Plane> start = associated_plane(all, "laser");
    const Associated<Line> line = associated_line(all, "laser");
    double longest = 0;
    for (const Vector3d& p : all) {
        longest = std::max(longest, (p - line.shape.point).norm());
    }
    if (line.rms < kOneLine * longest) {
        throw InputError(
            "laser: the lines on the boards lie on one line, through which many planes go; move the board in depth "
            "between the views");
    }
    const PlaneFrame frame = frame_of(start.shape);
    const BlockFit fit = fit_plane(camera, boards, frame);
    LaserCalibration result;
    result.plane = frame.moved(fit.shared);
    result.u = frame.u;
    result.v = frame.v;
    result.covariance = std::max(1.0, fit.variance_factor()) * fit.covariance();
    result.expanded_mm = largest_error(result, boards);
    add_lit_views(boards, frame, fit, result);
    judge_laser(limit_mm, fit.converged, result);
    return result;
}

}  // namespace seampath
