#include <Eigen/Dense>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/error.hpp"
#include "stages/optics/optics.hpp"
#include "tests/optics/boards.hpp"

/// The laser's plane from lines on boards with known truth.
namespace seampath {
namespace laser_test {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::Contains;
using testing::HasSubstr;

/// Some 25 degrees from the camera's axis, across the picture.
Plane laser_truth() {
    return {Vector3d(0, 0, 330), Vector3d(0, std::cos(0.44), -std::sin(0.44))};
}

/// Boards at working depths, and the line on each; errors of both from the seed.
std::vector<LitView> lines(int count, double sigma_px, std::uint64_t seed, double board_sigma_px) {
    const CameraModel camera = test::wide_camera();
    std::vector<LitView> views;
    Draws draws(seed, 4712);
    for (int i = 0; i < count; ++i) {
        Isometry3d place = Isometry3d::Identity();
        place.linear() = turn_by(Vector3d(draws.uniform(-0.4, 0.4), draws.uniform(-0.4, 0.4), draws.uniform(-0.1, 0.1)))
                             .toRotationMatrix();
        place.translation() = Vector3d(-75, -52, 290 + 80.0 * i / std::max(1, count - 1));
        LitView view{"view " + std::to_string(i + 1), {}, {}};
        view.board = locate_board(camera, test::seen(test::corners(), camera, place, board_sigma_px, seed * 50 + i), 0);
        const auto line = line_on_board(test::corners(), camera, place, laser_truth());
        for (std::size_t k = 0; k + 20 < line.size(); k += 20) {
            const Vector2d along = (line[k + 1] - line[k]).normalized(), normal(-along.y(), along.x());
            view.points.push_back({line[k] + sigma_px * draws.normal() * normal, normal, sigma_px});
        }
        views.push_back(view);
    }
    return views;
}

std::vector<LitView> lines(int count, double sigma_px, std::uint64_t seed) {
    return lines(count, sigma_px, seed, sigma_px);
}

/// Chi-squared of the plane's error, over its three numbers.
double chi_squared(const LaserCalibration& r) {
    const Plane truth = laser_truth();
    const double sign = r.plane.normal.dot(truth.normal) > 0 ? 1 : -1;
    const Vector3d turn = r.plane.normal.cross(sign * truth.normal);
    const Vector3d e(turn.dot(r.u), turn.dot(r.v), -signed_distance(truth, r.plane.point) * sign);
    return e.dot(r.covariance.ldlt().solve(e)) / 3;
}

/// Largest distance of the two planes over the working depth, where the laser is seen.
double largest_distance(const LaserCalibration& r) {
    double largest = 0;
    const Plane truth = laser_truth();
    const Vector3d down = Vector3d(0, truth.normal.z(), -truth.normal.y()) / -truth.normal.y();  // z grows by 1
    for (const double x : {-75.0, 75.0}) {
        for (const double z : {r.nearest_mm, r.furthest_mm}) {
            const Vector3d p = truth.point + Vector3d(x, 0, 0) + (z - truth.point.z()) * down;
            EXPECT_NEAR(signed_distance(truth, p), 0, 1e-9);
            largest = std::max(largest, std::abs(signed_distance(r.plane, p)));
        }
    }
    return largest;
}

TEST(CalibrateLaser, ExactLinesGiveThePlane) {
    const LaserCalibration r = calibrate_laser(test::wide_camera(), lines(6, 1e-6, 1), 0.05);
    EXPECT_LT(largest_distance(r), 1e-4);
    EXPECT_TRUE(r.pass()) << r.faults.front();
}

TEST(CalibrateLaser, NoiseOfAFifthOfAPixelLeavesTwoHundredths) {
    double squares = 0, worst = 0, chi2 = 0;
    int inside = 0;
    constexpr int kSets = 40;
    for (std::uint64_t seed = 1; seed <= kSets; ++seed) {
        const LaserCalibration r = calibrate_laser(test::wide_camera(), lines(15, 0.2, seed), 0.05);
        const double error = largest_distance(r);
        squares += error * error;
        worst = std::max(worst, error);
        inside += error <= r.expanded_mm;
        chi2 += chi_squared(r) / kSets;
    }
    std::cout << "plane over the working depth: rms of the largest error " << std::sqrt(squares / kSets)
              << " mm, worst " << worst << " mm; chi-squared " << chi2 << "; within what was stated: " << inside
              << " of " << kSets << "\n";
    EXPECT_LE(std::sqrt(squares / kSets), 0.02);
    EXPECT_GE(inside, 34);
    EXPECT_NEAR(chi2, 1, 3 * std::sqrt(2.0 / (3 * kSets)));
}

// With boards as good as known, what is left is the lines' own noise.
TEST(CalibrateLaser, SigmaOfTheLinesIsTrue) {
    constexpr int kSets = 30;
    double chi2 = 0;
    for (std::uint64_t seed = 1; seed <= kSets; ++seed) {
        chi2 += chi_squared(calibrate_laser(test::wide_camera(), lines(6, 0.2, seed, 1e-3), 0.05)) / kSets;
    }
    EXPECT_NEAR(chi2, 1, 3 * std::sqrt(2.0 / (3 * kSets)));
}

TEST(CalibrateLaser, PoorSetsSayWhatIsMissing) {
    const auto views = lines(6, 0.1, 1);
    const auto error = [](const std::vector<LitView>& given) {
        try {
            calibrate_laser(test::wide_camera(), given, 0.05);
            return std::string();
        } catch (const InputError& what) {
            return std::string(what.what());
        }
    };
    EXPECT_THAT(error({views[0]}), HasSubstr("1 views of its line on a board are too few"));
    EXPECT_THAT(error({views[0], views[0]}), HasSubstr("lie on one line"));
    auto none = views;
    none[2].points.clear();
    EXPECT_THAT(error(none), HasSubstr("view 3: the laser's line is not on the board"));
    EXPECT_THAT(calibrate_laser(test::wide_camera(), {views[0], views[5]}, 0.05).faults,
                Contains(HasSubstr("2 views leave nothing to check the plane with")));
}

}  // namespace laser_test
}  // namespace seampath
