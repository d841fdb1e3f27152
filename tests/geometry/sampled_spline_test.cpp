#include "stages/geometry/sampled_spline.hpp"

#include <gtest/gtest.h>

#include "stages/geometry/bspline.hpp"
#include "tests/geometry/curves.hpp"

namespace seampath {
namespace sampled_spline_test {

using Eigen::Vector3d;

TEST(SampledSpline, IsWithinItsToleranceOfTheCurve) {
    // Bends of 1 mm radius on a curve of 100 mm: only there the knots must be close.
    const auto wave = [](double s) { return Vector3d(s, 2 * std::exp(-(s - 30) * (s - 30) / 4), 0.1 * s); };
    const auto ring = [](double s) {
        return Vector3d(20 * std::cos(s / 20), 20 * std::sin(s / 20), 2 * std::sin(s / 4));
    };
    for (const bool closed : {false, true}) {
        const double length = closed ? 2 * kPi * 20 : 100;
        for (const double tolerance : {1e-3, 1e-6}) {
            const auto at = [&](double s) -> Vector3d { return closed ? ring(s) : wave(s); };
            const SampledSpline sampled = spline_through(at, length, closed, tolerance);
            EXPECT_EQ(sampled.curve.periodic, closed);
            EXPECT_LE(sampled.max_mm, tolerance);
            EXPECT_LE(sampled.rms_mm, sampled.max_mm);
            EXPECT_DOUBLE_EQ(last_parameter(sampled.curve) - first_parameter(sampled.curve), length);
            for (int i = 0; i <= 7000; ++i) {
                const double s = length * i / 7000;
                // At the end of a closed curve its beginning is meant, of an open one the end itself.
                EXPECT_LT((position(sampled.curve, s) - at(s)).norm(), 1.2 * tolerance) << s;
            }
        }
    }
}

TEST(SampledSpline, FollowsACubicExactlyWithoutFurtherKnots) {
    const auto cubic = [](double s) { return Vector3d(s, 1e-2 * s * s, 1e-3 * s * s * s); };
    const SampledSpline sampled = spline_through(cubic, 10, false, 1e-9);
    EXPECT_LT(sampled.max_mm, 1e-12);
    EXPECT_EQ(sampled.curve.control.size(), 64u + 3);
}

}  // namespace sampled_spline_test
}  // namespace seampath
