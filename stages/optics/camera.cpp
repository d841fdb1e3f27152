#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/geometry/block_fit.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/optics/board_view.hpp"
#include "stages/optics/optics.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr int kWithoutK3 = kCameraNumbers - 1;

VectorXd numbers_of(const CameraModel& c) {
    VectorXd x(kCameraNumbers);
    x << c.focal_px, c.centre_px, c.distortion[0], c.distortion[1], c.distortion[2], c.distortion[3], c.distortion[4];
    return x;
}

CameraModel camera_of(const CameraModel& like, const VectorXd& x) {
    CameraModel c = like;
    c.focal_px = x.segment<2>(0);
    c.centre_px = x.segment<2>(2);
    for (Index i = 4; i < x.size(); ++i) {
        c.distortion[static_cast<std::size_t>(i - 4)] = x[i];
    }
    return c;
}

/// Camera and places as they stand.
struct Bundle {
    CameraModel camera;
    std::vector<Isometry3d> places;
    std::vector<BoardView> views;
    double circle_radius_mm = 0;
};

/// So many of the camera's numbers, and all places, by least squares; moves the bundle.
BlockFit adjust(Bundle& bundle, Index numbers) {
    BlockProblem problem;
    problem.blocks = bundle.views.size();
    problem.shared_unit = VectorXd::Constant(numbers, 1e-6);  // of the distortion
    problem.shared_unit.head<4>().setConstant(1e-3);          // px
    problem.own_unit = optics::pose_unit();
    problem.residuals = [&](std::size_t i, const VectorXd& x, const VectorXd& step) {
        const Isometry3d place = displaced(bundle.places[i], step, bundle.places[i].translation());
        return optics::residuals_of(camera_of(bundle.camera, x), place, bundle.views[i].points,
                                    bundle.circle_radius_mm);
    };
    BlockFit fit = fit_blocks(problem, numbers_of(bundle.camera).head(numbers),
                              std::vector<VectorXd>(bundle.views.size(), VectorXd::Zero(6)));
    bundle.camera = camera_of(bundle.camera, fit.shared);
    for (std::size_t i = 0; i < bundle.places.size(); ++i) {
        bundle.places[i] = displaced(bundle.places[i], fit.own[i], bundle.places[i].translation());
    }
    return fit;
}

/// Takes points away that lie far off; a board's corner in a highlight or at its edge is found in the wrong place.
void drop_far_points(Bundle& bundle, std::vector<ViewResult>& results) {
    constexpr double kFar = 5;                // robust sigmas
    constexpr double kMedianOfRing = 1.1774;  // of two normal errors' distance, in their sigma
    std::vector<double> all;
    for (std::size_t i = 0; i < bundle.views.size(); ++i) {
        const VectorXd r =
            optics::residuals_of(bundle.camera, bundle.places[i], bundle.views[i].points, bundle.circle_radius_mm);
        for (Index k = 0; k < r.size(); k += 2) {
            all.push_back(r.segment<2>(k).norm());
        }
    }
    const std::vector<double> distance = all;
    const double far = kFar * quantile(all, 0.5) / kMedianOfRing;
    std::size_t next = 0;
    for (std::size_t i = 0; i < bundle.views.size(); ++i) {
        const auto dropped =
            std::erase_if(bundle.views[i].points, [&](const BoardSight&) { return distance[next++] > far; });
        results[i].dropped = static_cast<int>(dropped);
    }
}

void add_views(const Bundle& bundle, const BlockFit& fit, CameraCalibration& result) {
    double squares = 0, held_out = 0, points = 0;
    for (std::size_t i = 0; i < bundle.views.size(); ++i) {
        ViewResult& view = result.views[i];
        view.camera_from_board = bundle.places[i];
        view.points = static_cast<int>(bundle.views[i].points.size());
        view.tilt_rad = std::acos(std::min(1.0, std::abs(bundle.places[i].linear()(2, 2))));
        const VectorXd r =
            optics::residuals_of(bundle.camera, bundle.places[i], bundle.views[i].points, bundle.circle_radius_mm);
        view.rms_px = std::sqrt(r.squaredNorm() / view.points);
        const CameraModel without = camera_of(bundle.camera, fit.shared + without_block(fit, i).step);
        view.held_out_px =
            optics::refined_place(without, bundle.views[i], bundle.places[i], bundle.circle_radius_mm).rms_px;
        squares += r.squaredNorm();
        held_out += view.held_out_px * view.held_out_px * view.points;
        points += view.points;
        for (Index k = 0; k < view.points; ++k) {
            const Vector2d& at = bundle.views[i].points[static_cast<std::size_t>(k)].pixel;
            const auto cell = [](double x, int size, std::size_t cells) {
                const double share = std::max(0.0, (x + 0.5) / size);
                return std::min(static_cast<std::size_t>(share * static_cast<double>(cells)), cells - 1);
            };
            ResidualCell& c = result.map[cell(at.y(), bundle.camera.height, CameraCalibration::kMapRows) *
                                             CameraCalibration::kMapColumns +
                                         cell(at.x(), bundle.camera.width, CameraCalibration::kMapColumns)];
            c.mean_px += r.segment<2>(2 * k);
            c.rms_px += r.segment<2>(2 * k).squaredNorm();
            ++c.points;
        }
    }
    for (ResidualCell& c : result.map) {
        c.mean_px /= std::max(1, c.points);
        c.rms_px = std::sqrt(c.rms_px / std::max(1, c.points));
    }
    result.rms_px = std::sqrt(squares / points);
    result.held_out_px = std::sqrt(held_out / points);
}

/// What the views lack, by their geometry alone.
void add_missing(CameraCalibration& result) {
    constexpr std::size_t kFewViews = 5;
    constexpr double kTilt = 15 * kDegree;
    constexpr std::array<const char*, 9> kPlaces{"upper left", "upper middle", "upper right",  "left",       "middle",
                                                 "right",      "lower left",   "lower middle", "lower right"};
    if (result.views.size() < kFewViews) {
        result.faults.push_back(std::to_string(result.views.size()) +
                                " views are too few to tell how good they are; take 10 or more");
    }
    double tilt = 0;
    for (const ViewResult& view : result.views) {
        tilt = std::max(tilt, view.tilt_rad);
    }
    if (tilt < kTilt) {
        result.faults.push_back("no view is tilted by more than " + fixed(tilt / kDegree, 1) +
                                " degrees, so that focal length and distance can't be told apart; tilt the board by 20 "
                                "to 45 degrees, about both axes");
    }
    std::string empty;
    for (std::size_t part = 0; part < 9; ++part) {
        int points = 0;
        for (std::size_t row = 0; row < CameraCalibration::kMapRows; ++row) {
            for (std::size_t column = 0; column < CameraCalibration::kMapColumns; ++column) {
                const bool in = row * 3 / CameraCalibration::kMapRows == part / 3 &&
                                column * 3 / CameraCalibration::kMapColumns == part % 3;
                points += in ? result.map[row * CameraCalibration::kMapColumns + column].points : 0;
            }
        }
        if (points == 0) {
            empty += (empty.empty() ? "" : ", ") + std::string(kPlaces[static_cast<std::size_t>(part)]);
        }
    }
    if (!empty.empty()) {
        result.faults.push_back(
            "no point of the board was seen in these parts of the picture, where the lens stays "
            "unknown: " +
            empty + "; take views with the board there");
    }
}

void judge_camera(const CameraOptions& options, bool converged, CameraCalibration& result) {
    if (!converged) {
        result.faults.emplace_back("the least squares did not converge; check the board's dimensions and kind");
    }
    add_missing(result);
    for (Index i = 0; i < 2; ++i) {
        const double percent = 100 * std::sqrt(result.covariance(i, i)) / result.camera.focal_px[i];
        if (!(percent <= options.limit_percent)) {
            result.faults.push_back("the focal length f" + std::string(i == 0 ? "x" : "y") + " is known to " +
                                    fixed(percent, 3) + " % only (1-sigma); the limit is " +
                                    shortest(options.limit_percent) + " %; take more views, nearer and more tilted");
        }
    }
    int dropped = 0;
    for (const ViewResult& view : result.views) {
        dropped += view.dropped;
    }
    if (dropped > 0) {
        result.notes.push_back(std::to_string(dropped) + " points far from where the others put them were dropped");
    }
}

}  // namespace

CameraCalibration calibrate_camera(const std::vector<BoardView>& views, const CameraOptions& options) {
    constexpr std::size_t kLeastViews = 3;
    if (views.size() < kLeastViews) {
        throw InputError("camera: the board was found in " + std::to_string(views.size()) +
                         " views; at least 3, better 10 or more, were needed");
    }
    Bundle bundle{optics::first_camera(views, options.width, options.height), {}, views, options.circle_radius_mm};
    CameraCalibration result;
    for (const BoardView& view : views) {
        optics::check_points(view);
        bundle.places.push_back(optics::first_place(bundle.camera, view));
        result.views.push_back({view.name, 0, 0, 0, 0, 0, {}});
    }
    adjust(bundle, kWithoutK3);
    drop_far_points(bundle, result.views);
    BlockFit fit = adjust(bundle, kCameraNumbers);
    constexpr double kShown = 3;  // sigmas
    const double sigma_k3 = std::sqrt(fit.variance_factor() * fit.covariance()(8, 8));
    if (!(std::abs(bundle.camera.distortion[4]) > kShown * sigma_k3)) {
        bundle.camera.distortion[4] = 0;
        fit = adjust(bundle, kWithoutK3);
    }
    result.camera = bundle.camera;
    result.covariance.topLeftCorner(fit.shared.size(), fit.shared.size()) = fit.variance_factor() * fit.covariance();
    result.sigma_px = std::sqrt(fit.variance_factor());
    add_views(bundle, fit, result);
    judge_camera(options, fit.converged, result);
    return result;
}

}  // namespace seampath
