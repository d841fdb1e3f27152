#include "stages/geometry/section.hpp"

#include <gtest/gtest.h>

#include "tests/geometry/clouds.hpp"

namespace seampath {
namespace section_test {

using Eigen::Vector3d;

constexpr double kDegree = 0.017453292519943295;

/// Floor z = 0 and a wall through the x axis that makes the opening angle with it.
std::vector<Eigen::Vector3f> wedge(double opening, const Sampling& sampling) {
    std::vector<Eigen::Vector3f> points;
    add_rectangle(points, {-25, 0, 0}, Vector3d::UnitX(), 50, Vector3d::UnitY(), 25, sampling);
    add_rectangle(points, {-25, 0, 0}, Vector3d::UnitX(), 50, Vector3d(0, std::cos(opening), std::sin(opening)), 25,
                  sampling);
    return points;
}

/// n1 of the floor, n2 of the wall, out of the material.
Section wedge_section(double opening) {
    return {{0, 0, 0}, {0, 0, 1}, {0, std::sin(opening), -std::cos(opening)}};
}

TEST(Section, TwoExactPlanesMeetWhereTheyMeet) {
    for (const double degrees : {40.0, 60.0, 90.0, 120.0, 150.0}) {
        const double opening = degrees * kDegree;
        const auto points = wedge(opening, {0.3, 0, 2});
        const ScanScale scale{0.3, 0.01, 1};
        const PointGrid grid(points, 1.2);
        Section guess = wedge_section(opening);
        guess.p = {1, 0.4, -0.3};
        const auto fit = fit_section(grid, scale, guess, {8, 10, 1.2});
        ASSERT_TRUE(fit) << degrees;
        EXPECT_LT(fit->section.p.tail<2>().norm(), 1e-5) << degrees;
        EXPECT_NEAR(fit->section.p.x(), 1, 1e-9);
        EXPECT_NEAR(fit->bend, 3.141592653589793 - opening, 1e-5) << degrees;
        EXPECT_LT((fit->section.n1 - wedge_section(opening).n1).norm(), 1e-5);
        EXPECT_LT((fit->section.n2 - wedge_section(opening).n2).norm(), 1e-5);
        EXPECT_NEAR(fit->shift, 0.5, 1e-5);
        EXPECT_LT(std::abs(fit->flank[0].fit.coefficients()[0] - 0.3), 1e-5) << "floor over the guess";
    }
}

TEST(Section, ErrorOfNoisyPlanesIsWhatSigmaSays) {
    const Section truth = wedge_section(75 * kDegree);
    double sum = 0;
    constexpr int kTrials = 60;
    for (int i = 0; i < kTrials; ++i) {
        const auto points = wedge(75 * kDegree, {0.3, 0.045, 100 + static_cast<std::uint64_t>(i)});
        const PointGrid grid(points, 1.2);
        const auto fit = fit_section(grid, {0.3, 0.045, 1}, truth, {6, 8, 1.2});
        ASSERT_TRUE(fit);
        sum += fit->section.p.tail<2>().squaredNorm() / (fit->sigma * fit->sigma);
    }
    // A mean of 60 squares of two numbers each: within 40 % of 1.
    EXPECT_GT(sum / kTrials, 0.6);
    EXPECT_LT(sum / kTrials, 1.4);
}

TEST(Section, PipeOnPlateMeetsOnItsCircle) {
    std::vector<Eigen::Vector3f> points;
    add_cylinder(points, 40, 20, {0.3, 0, 3}, -0.6, 0.6);
    add_rectangle(points, {40, -25, 0}, Vector3d::UnitX(), 25, Vector3d::UnitY(), 50, {0.3, 0, 4});
    // The plate carries on under the circle's arc beside the section.
    std::erase_if(points, [](const Eigen::Vector3f& p) { return p.head<2>().norm() < 39.99f; });
    const PointGrid grid(points, 1.2);
    const Section guess{{40.2, 0, 0.2}, {0, 0, 1}, {1, 0, 0}};
    const auto fit = settle_section(grid, {0.3, 0.01, 1}, guess, {8, 10, 1.2}, 6);
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->section.p.head<2>().norm(), 40, 2e-3);
    EXPECT_NEAR(fit->section.p.z(), 0, 2e-3);
    EXPECT_NEAR(fit->bend, 90 * kDegree, 2e-3);
}

TEST(Section, SeesRoundFlanksAndBentSeamsWithAWideWindow) {
    // The window is as wide as the pipe: neither is the pipe a parabola in it nor the seam a straight line.
    constexpr double kRadius = 20;
    std::vector<Eigen::Vector3f> points;
    add_cylinder(points, kRadius, 30, {0.3, 0.02, 3}, -1.5, 1.5);
    add_rectangle(points, {-10, -40, 0}, Vector3d::UnitX(), 60, Vector3d::UnitY(), 80, {0.3, 0.02, 4});
    std::erase_if(points, [](const Eigen::Vector3f& p) { return p.z() < 0.3f && p.head<2>().norm() < kRadius; });
    const PointGrid grid(points, 1.2);
    const Section guess{{kRadius + 0.2, 0, 0.2}, {0, 0, 1}, {1, 0, 0}};
    const auto fit = settle_section(grid, {0.3, 0.02, 1}, guess, {20, 20, 1.2}, 6);
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->section.p.head<2>().norm(), kRadius, 0.01);
    EXPECT_NEAR(fit->section.p.z(), 0, 0.01);
    EXPECT_LT(fit->sigma, 0.01);
    EXPECT_GT(fit->flank[0].window.along, 19) << "the plate is flat";
    EXPECT_GT(fit->flank[1].window.away, 19) << "and the pipe straight along its axis";
}

TEST(Section, SigmaKnowsOfNoiseThatNeighboursShare) {
    // Each sample's noise is that of its cell of 1.5 mm, some 25 points.
    const auto points_with = [](std::uint64_t seed) {
        auto points = wedge(90 * kDegree, {0.3, 0, seed});
        const Random random(seed, 77);
        for (auto& p : points) {
            const bool floor = p.z() < 1e-6f;
            const auto column = static_cast<std::uint64_t>((p.x() + 25) / 1.5f),
                       row = static_cast<std::uint64_t>((floor ? p.y() : p.z()) / 1.5f);
            (floor ? p.z() : p.y()) +=
                static_cast<float>(0.045 * random.normal(column * 1000 + row + (floor ? 0 : 500)));
        }
        return points;
    };
    double sum = 0;
    constexpr int kTrials = 40;
    for (std::uint64_t i = 0; i < kTrials; ++i) {
        const auto points = points_with(i + 1);
        // The scan as a whole did not tell: a correlation of 1.
        const auto fit =
            fit_section(PointGrid(points, 1.2), {0.3, 0.045, 1}, wedge_section(90 * kDegree), {15, 15, 1.2});
        ASSERT_TRUE(fit);
        sum += fit->section.p.tail<2>().squaredNorm() / (fit->sigma * fit->sigma);
    }
    EXPECT_GT(sum / kTrials, 0.5);
    EXPECT_LT(sum / kTrials, 2);
}

TEST(Section, IgnoresTheCornerBandItself) {
    auto points = wedge(90 * kDegree, {0.3, 0, 2});
    // A radius of 1 mm instead of the corner.
    for (auto& p : points) {
        if (p.y() < 1 && p.z() < 1) {
            const Eigen::Vector2f r = Eigen::Vector2f(p.y() - 1, p.z() - 1).normalized();
            p.y() = 1 + r.x();
            p.z() = 1 + r.y();
        }
    }
    const PointGrid grid(points, 1.2);
    const auto fit = fit_section(grid, {0.3, 0.01, 1}, wedge_section(90 * kDegree), {8, 10, 1.2});
    ASSERT_TRUE(fit);
    EXPECT_LT(fit->section.p.norm(), 1e-5);
}

TEST(Section, NeedsBothFlanks) {
    std::vector<Eigen::Vector3f> floor;
    add_rectangle(floor, {-25, 0, 0}, Vector3d::UnitX(), 50, Vector3d::UnitY(), 25, {0.3, 0.02, 2});
    const PointGrid grid(floor, 1.2);
    EXPECT_FALSE(fit_section(grid, {0.3, 0.02, 1}, wedge_section(90 * kDegree), {8, 10, 1.2}));
}

TEST(Section, ParallelFlanksDoNotMeet) {
    const auto points = wedge(90 * kDegree, {0.3, 0, 2});
    const PointGrid grid(points, 1.2);
    EXPECT_FALSE(fit_section(grid, {0.3, 0.01, 1}, {{0, 0, 0}, {0, 0, 1}, {0, 0, 1}}, {8, 10, 1.2}));
}

}  // namespace section_test
}  // namespace seampath
