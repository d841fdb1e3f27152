#include <chrono>

#include <gtest/gtest.h>

#include "tests/fit/models.hpp"

/// Noisy points of the curve in which two pipes meet, with outliers.
namespace seampath {
namespace saddle_test {

using Eigen::Vector3d;

struct Saddle {
    double branch_radius;
    double header_radius = 600;
    Vector3d operator()(double x) const {
        const double t = 2 * kPi * x, y = branch_radius * std::sin(t);
        return {branch_radius * std::cos(t), y, std::sqrt(header_radius * header_radius - y * y)};
    }
};

// Sigma 0.1 mm along each axis; one point in twenty is off by 2 mm to anywhere.
Seam measured(const Saddle& saddle, std::uint64_t seed) {
    constexpr double kSigma = 0.1, kOff = 2, kOutliers = 0.05;
    Seam seam = seam_along(saddle, 2000, true, kSigma);
    const Random noise(seed, 1), outlier(seed, 2);
    for (std::size_t i = 0; i < seam.points.size(); ++i) {
        const auto isotropic = [i](const Random& r) {
            return Vector3d(r.normal(3 * i), r.normal(3 * i + 1), r.normal(3 * i + 2));
        };
        seam.points[i].p += kSigma * isotropic(noise);
        if (Random(seed, 3).uniform(i) < kOutliers) {
            seam.points[i].p += kOff * isotropic(outlier).normalized();
        }
    }
    return seam;
}

struct Errors {
    double rms, largest;
};

Errors errors(const SeamModel& model, const Saddle& saddle) {
    constexpr int kSamples = 400;
    const ArcLength arc(model.curve);
    double squares = 0, largest = 0;
    for (int i = 0; i < kSamples; ++i) {
        const double d = distance_to(saddle, position(model.curve, arc.parameter(arc.length() * i / kSamples)));
        squares += d * d;
        largest = std::max(largest, d);
    }
    return {std::sqrt(squares / kSamples), largest};
}

constexpr std::uint64_t kSeeds[] = {1, 2, 3, 4, 5, 6};

TEST(Fit, FollowsASaddle) {
    // 16 coefficients per axis, of 1900 points: 0.1 mm * sqrt(2 * 16 / 1900) = 0.013 mm, by chance more or less.
    double squares = 0;
    for (const std::uint64_t seed : kSeeds) {
        const Errors e = errors(model_of(measured({150}, seed)), {150});
        squares += e.rms * e.rms;
        EXPECT_LT(e.rms, 0.018) << "seed " << seed;
        EXPECT_LT(e.largest, 0.04) << "seed " << seed;
    }
    EXPECT_LT(std::sqrt(squares / std::size(kSeeds)), 0.0145);
}

TEST(Fit, FollowsASaddleOfNearlyEqualPipes) {
    for (const std::uint64_t seed : kSeeds) {
        const Errors e = errors(model_of(measured({588}, seed)), {588});
        EXPECT_LT(e.rms, 0.035) << "seed " << seed;
        EXPECT_LT(e.largest, 0.11) << "seed " << seed;
    }
}

TEST(Fit, TakesTimeInProportionToThePoints) {
    const auto seconds = [](int points) {
        const Seam seam = noisy(seam_along(CircleCurve{300}, points, true), 0.05, 1);
        double best = 1e9;
        for (int repeat = 0; repeat < 3; ++repeat) {
            const auto start = std::chrono::steady_clock::now();
            fit(seam, {}, {});
            best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        }
        return best;
    };
    EXPECT_LT(seconds(16000), 8 * 4 * seconds(2000));  // a cubic one would take 512 times as long
}

}  // namespace saddle_test
}  // namespace seampath
