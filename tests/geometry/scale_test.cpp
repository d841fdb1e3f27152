#include "stages/geometry/scale.hpp"

#include <gtest/gtest.h>

#include "tests/geometry/clouds.hpp"

namespace seampath {
namespace scale_test {

std::vector<Eigen::Vector3f> plane(double pitch, double sigma) {
    std::vector<Eigen::Vector3f> points;
    const Eigen::Vector3d a = Eigen::Vector3d(1, 0.3, -0.2).normalized();
    const Eigen::Vector3d b = a.cross(Eigen::Vector3d(0.1, 0.2, 1)).normalized();
    add_rectangle(points, {10, -20, 30}, a, 200 * pitch, b, 150 * pitch, {pitch, sigma, 4});
    return points;
}

/// A raster with noise that a Gaussian kernel of so many pixels' width ties together, of standard deviation sigma.
std::vector<Eigen::Vector3f> correlated_plane(double pitch, double sigma, double width) {
    constexpr int kColumns = 240, kRows = 200, kReach = 6;
    constexpr std::ptrdiff_t kWide = kColumns + 2 * kReach;
    const Random random(9, 0);
    double squares = 0;
    const auto kernel = [&](int dx, int dy) { return std::exp(-(dx * dx + dy * dy) / (2 * width * width)); };
    for (int dy = -kReach; dy <= kReach; ++dy) {
        for (int dx = -kReach; dx <= kReach; ++dx) {
            squares += kernel(dx, dy) * kernel(dx, dy);
        }
    }
    std::vector<double> white(kWide * (kRows + 2 * kReach));
    for (std::size_t i = 0; i < white.size(); ++i) {
        white[i] = random.normal(i);
    }
    std::vector<Eigen::Vector3f> points;
    for (int y = 0; y < kRows; ++y) {
        for (int x = 0; x < kColumns; ++x) {
            double z = 0;
            for (int dy = -kReach; dy <= kReach; ++dy) {
                for (int dx = -kReach; dx <= kReach; ++dx) {
                    z += kernel(dx, dy) * white[static_cast<std::size_t>((y + dy + kReach) * kWide + x + dx + kReach)];
                }
            }
            points.emplace_back(static_cast<float>(x * pitch), static_cast<float>(y * pitch),
                                static_cast<float>(sigma * z / std::sqrt(squares)));
        }
    }
    return points;
}

TEST(ScanScale, RecoversSpacingAndNoiseOfAPlane) {
    for (const double pitch : {0.1, 0.3, 2.0}) {
        for (const double share : {0.05, 0.15, 0.5}) {
            const ScanScale scale = estimate_scale(plane(pitch, share * pitch)).overall;
            EXPECT_NEAR(scale.spacing, pitch, 0.1 * pitch);
            EXPECT_NEAR(scale.noise, share * pitch, 0.05 * share * pitch) << "pitch " << pitch;
            EXPECT_LT(scale.correlation, 1.5) << "of white noise, pitch " << pitch;
        }
    }
}

TEST(ScanScale, SeesNoiseLargerThanTheSpacing) {
    const ScanScale scale = estimate_scale(plane(0.3, 0.9)).overall;
    EXPECT_NEAR(scale.noise, 0.9, 0.1);
}

TEST(ScanScale, OfExactPointsHasNoNoise) {
    EXPECT_LT(estimate_scale(plane(0.3, 0)).overall.noise, 1e-5);
}

TEST(ScanScale, TellsCorrelatedNoiseFromWhite) {
    const ScanScale white = estimate_scale(correlated_plane(0.3, 0.05, 1e-3)).overall;
    const ScanScale narrow = estimate_scale(correlated_plane(0.3, 0.05, 0.8)).overall;
    const ScanScale wide = estimate_scale(correlated_plane(0.3, 0.05, 1.2)).overall;
    EXPECT_LT(white.correlation, 1.5);
    // The variance of a mean over many pixels grows by 4 pi width^2.
    EXPECT_NEAR(narrow.correlation, 4 * 3.1416 * 0.8 * 0.8, 0.4 * 4 * 3.1416 * 0.8 * 0.8);
    EXPECT_NEAR(wide.correlation, 4 * 3.1416 * 1.2 * 1.2, 0.4 * 4 * 3.1416 * 1.2 * 1.2);
    for (const ScanScale& scale : {white, narrow, wide}) {
        EXPECT_NEAR(scale.noise, 0.05, 0.005);
    }
}

TEST(ScanScale, IsThatOfTheSurfaceInSpiteOfStrayPoints) {
    auto points = plane(0.3, 0.045);
    for (int i = 0; i < 30; ++i) {
        points.emplace_back(1000.f * static_cast<float>(i), -500.f, 3000.f);
    }
    const ScanScale scale = estimate_scale(points).overall;
    EXPECT_NEAR(scale.spacing, 0.3, 0.04);
    EXPECT_NEAR(scale.noise, 0.045, 0.005);
}

TEST(ScanScale, OfAFewPointsOrOfOnePlaceIsNothing) {
    EXPECT_EQ(estimate_scale(std::vector<Eigen::Vector3f>(49, Eigen::Vector3f(1, 2, 3))).overall.spacing, 0);
    EXPECT_EQ(estimate_scale(std::vector<Eigen::Vector3f>(5000, Eigen::Vector3f(1, 2, 3))).overall.spacing, 0);
}

TEST(ScanScale, ScalesWithTheScan) {
    auto points = plane(0.3, 0.045);
    const ScanScale one = estimate_scale(points).overall;
    for (auto& p : points) {
        p *= 1000;
    }
    const ScanScale thousand = estimate_scale(points).overall;
    EXPECT_NEAR(thousand.spacing, 1000 * one.spacing, 0.1 * one.spacing);
    EXPECT_NEAR(thousand.noise, 1000 * one.noise, 10 * one.noise);
}

TEST(ScaleField, SaysWhereTheScanIsCoarserAndNoisier) {
    // As a depth camera sees a near plate and one behind it: twice the pitch, four times the noise.
    auto points = plane(0.3, 0.045);
    for (const Eigen::Vector3f& p : plane(0.6, 0.18)) {
        points.push_back(p + Eigen::Vector3f(0, 0, 300));
    }
    const ScaleField field = estimate_scale(points);
    int near = 0;
    for (std::size_t k = 0; k < field.place.size(); ++k) {
        const bool behind = field.place[k].z() > 180;
        const ScanScale here = field.at(field.place[k]);
        EXPECT_NEAR(here.spacing, behind ? 0.6 : 0.3, behind ? 0.06 : 0.03);
        EXPECT_NEAR(here.noise, behind ? 0.18 : 0.045, behind ? 0.04 : 0.01);
        near += !behind;
    }
    EXPECT_GT(near, 40);
    EXPECT_LT(near, 360);
}

}  // namespace scale_test
}  // namespace seampath
