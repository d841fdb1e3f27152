#include "stages/fit/fit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/error.hpp"
#include "stages/geometry/bspline.hpp"
#include "tests/fit/models.hpp"

namespace seampath {
namespace fit_test {

using Eigen::Vector3d;

Seam reversed(Seam seam) {
    std::reverse(seam.points.begin(), seam.points.end());
    for (SeamPoint& point : seam.points) {
        std::swap(point.n1, point.n2);
    }
    return seam;
}

TEST(Fit, RecoversKnownCurves) {
    // Exact points, whatever sigma they state: what is left is how far a cubic spline through them is from the curve.
    EXPECT_LT(largest_error(model_of(seam_along(CircleCurve{30}, 250, true)), CircleCurve{30}), 1e-5);
    EXPECT_LT(largest_error(model_of(seam_along(Helix{25, 12, 1.5}, 400, false)), Helix{25, 12, 1.5}), 1e-5);
    EXPECT_LT(largest_error(model_of(seam_along(SineCurve{200, 18}, 300, false)), SineCurve{200, 18}), 3e-5);
    EXPECT_LT(largest_error(model_of(seam_along(Straight{{5, -3, 2}, {95, 10, 30}}, 90, false)),
                            Straight{{5, -3, 2}, {95, 10, 30}}),
              1e-6);
}

TEST(Fit, TakesSixPoints) {
    const Straight line{{5, -3, 2}, {95, 10, 30}};
    EXPECT_LT(largest_error(model_of(seam_along(line, 6, false)), line), 1e-6);
    EXPECT_LT(largest_error(model_of(noisy(seam_along(line, 6, false), 0.03, 3)), line), 0.1);
    EXPECT_LT(largest_error(model_of(seam_along(CircleCurve{30}, 8, true)), CircleCurve{30}), 0.05);
}

TEST(Fit, DoesNotFloatWherePointsAreMissing) {
    constexpr double kSigma = 0.02;
    for (const std::uint64_t seed : {1, 2, 3}) {
        Seam circle = noisy(seam_along(CircleCurve{30}, 250, true), kSigma, seed);
        circle.points.erase(circle.points.begin() + 60, circle.points.begin() + 75);  // 11 mm
        EXPECT_LT(largest_error(model_of(circle), CircleCurve{30}), 5 * kSigma) << "seed " << seed;
        const Straight line{{0, 0, 0}, {90, 0, 0}};
        Seam straight = noisy(seam_along(line, 91, false), kSigma, seed);
        straight.points.erase(straight.points.begin() + 30, straight.points.begin() + 60);
        EXPECT_LT(largest_error(model_of(straight), line), 5 * kSigma) << "seed " << seed;
    }
}

TEST(Fit, EndsWhereTheSeamEnds) {
    constexpr double kSigma = 0.02;
    const SineCurve sine{200, 18};
    for (const std::uint64_t seed : {1, 2, 3}) {
        const SeamModel model = model_of(noisy(seam_along(sine, 300, false), kSigma, seed));
        EXPECT_LT((position(model.curve, first_parameter(model.curve)) - sine(0)).norm(), 3 * kSigma);
        EXPECT_LT((position(model.curve, last_parameter(model.curve)) - sine(1)).norm(), 3 * kSigma);
    }
}

TEST(Fit, CountsTheFreedomItTakes) {
    const Straight line{{0, 0, 0}, {90, 0, 0}};
    const SeamModel straight = model_of(noisy(seam_along(line, 200, false), 0.02, 1));
    EXPECT_GE(straight.degrees_of_freedom, 3 * 2.99);  // a parabola is free
    EXPECT_LT(straight.degrees_of_freedom, 3 * 8);
    const SeamModel wave = model_of(noisy(seam_along(SineCurve{200, 18}, 300, false), 0.02, 1));
    EXPECT_GT(wave.degrees_of_freedom, 3 * 8);
    EXPECT_LT(wave.degrees_of_freedom, 3 * 60);
    EXPECT_LT(wave.degrees_of_freedom, 3 * static_cast<double>(wave.curve.control.size()));
}

TEST(Fit, KnowsTheLength) {
    const Helix helix{25, 12, 1.5};
    EXPECT_NEAR(model_of(seam_along(helix, 400, false)).length_mm, helix.length(), 0.01);
    EXPECT_NEAR(model_of(seam_along(CircleCurve{30}, 250, true)).length_mm, 2 * kPi * 30, 0.02);
    EXPECT_NEAR(model_of(seam_along(Straight{{0, 0, 0}, {30, 40, 0}}, 50, false)).length_mm, 50, 1e-6);
}

TEST(Fit, AveragesNoiseOut) {
    constexpr double kSigma = 0.05;
    const SeamModel model = model_of(noisy(seam_along(CircleCurve{30}, 300, true), kSigma, 3));
    EXPECT_LT(largest_error(model, CircleCurve{30}), 1.2 * kSigma);
    EXPECT_NEAR(model.residual_rms_mm, kSigma, 0.15 * kSigma);
    double squares = 0;
    for (int i = 0; i < 300; ++i) {
        const Vector3d p = position(model.curve, first_parameter(model.curve) + i * 2 * kPi * 30 / 300);
        squares += std::pow(distance_to(CircleCurve{30}, p), 2);
    }
    EXPECT_LT(std::sqrt(squares / 300), 0.45 * kSigma);
}

TEST(Fit, HoldsAgainstOutliers) {
    Seam seam = noisy(seam_along(SineCurve{200, 18}, 300, false), 0.02, 4);
    for (std::size_t i = 11; i < 290; i += 23) {
        seam.points[i].p.z() += 1.5;
    }
    EXPECT_LT(largest_error(model_of(seam), SineCurve{200, 18}), 0.08);
}

TEST(Fit, FollowsABendSharpAgainstTheRest) {
    // Two long straights joined by an arc of 8 mm: the bend is no outlier.
    const auto shape = [](double x) {
        const double s = x * (80 + 8 * kPi / 2) - 40;
        const double angle = std::clamp(s / 8, 0.0, kPi / 2);
        const Vector3d arc(8 * std::sin(angle), 8 - 8 * std::cos(angle), 0);
        return Vector3d(arc + Vector3d(std::min(s, 0.0), std::max(s - 8 * kPi / 2, 0.0), 0));
    };
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
        EXPECT_LT(largest_error(model_of(noisy(seam_along(shape, 95, false), 0.015, seed)), shape), 0.08)
            << "seed " << seed;
    }
}

TEST(Fit, ClosedCurveGoesOnSmoothlyWhereItCloses) {
    const SeamModel model = model_of(noisy(seam_along(CircleCurve{30}, 250, true), 0.02, 5));
    ASSERT_TRUE(model.curve.periodic);
    const double first = first_parameter(model.curve), last = last_parameter(model.curve);
    constexpr double kNear = 1e-9;
    EXPECT_LT((position(model.curve, first + kNear) - position(model.curve, last - kNear)).norm(), 1e-7);
    EXPECT_LT((derivative(model.curve, first + kNear) - derivative(model.curve, last - kNear)).norm(), 1e-7);
    EXPECT_LT((second_derivative(model.curve, first + kNear) - second_derivative(model.curve, last - kNear)).norm(),
              1e-7);
}

TEST(Fit, ClosedCurveDoesNotHangOnWhereItStarts) {
    Seam seam = noisy(seam_along(CircleCurve{30}, 250, true), 0.01, 6);
    const SeamModel one = model_of(seam);
    std::rotate(seam.points.begin(), seam.points.begin() + 77, seam.points.end());
    const SeamModel other = model_of(seam);
    for (int i = 0; i < 100; ++i) {
        const Vector3d p = position(one.curve, first_parameter(one.curve) + i);
        EXPECT_LT((position(other.curve, nearest_parameter(other.curve, p)) - p).norm(), 0.02);
    }
}

TEST(Fit, OfAReversedSeamIsTheReversedCurve) {
    for (const bool closed : {false, true}) {
        const Seam seam = noisy(
            closed ? seam_along(CircleCurve{30}, 250, true) : seam_along(SineCurve{200, 18}, 300, false), 0.01, 7);
        const SeamModel ahead = model_of(seam), back = model_of(reversed(seam));
        EXPECT_NEAR(ahead.length_mm, back.length_mm, 0.02);
        const ArcLength arc(ahead.curve);
        for (int i = 1; i < 100; ++i) {
            const double u = arc.parameter(arc.length() * i / 100);
            const double v = nearest_parameter(back.curve, position(ahead.curve, u));
            EXPECT_LT((position(back.curve, v) - position(ahead.curve, u)).norm(), 0.02)
                << (closed ? "closed " : "open ") << i;
            EXPECT_LT(tangent(back.curve, v).dot(tangent(ahead.curve, u)), -0.99);
        }
    }
}

TEST(Fit, MovesWithItsSeam) {
    const Eigen::Isometry3d move =
        Eigen::Translation3d(100, -200, 50) * Eigen::AngleAxisd(1.1, Vector3d(1, 2, -1).normalized());
    Seam seam = noisy(seam_along(Helix{25, 12, 1.5}, 300, false), 0.01, 8);
    const SeamModel here = model_of(seam);
    for (SeamPoint& point : seam.points) {
        point.p = move * point.p;
        point.n1 = move.linear() * point.n1;
        point.n2 = move.linear() * point.n2;
    }
    const SeamModel there = model_of(seam);
    EXPECT_NEAR(here.length_mm, there.length_mm, 1e-6);
    for (int i = 0; i <= 50; ++i) {
        const double x = i / 50.0;
        const auto at = [x](const SeamModel& m) {
            return position(m.curve,
                            first_parameter(m.curve) + x * (last_parameter(m.curve) - first_parameter(m.curve)));
        };
        EXPECT_LT((move * at(here) - at(there)).norm(), 1e-6);
    }
}

TEST(Fit, StationsOfTheFlanksAreArcLengthsOfTheirPoints) {
    for (const bool closed : {false, true}) {
        const Seam seam = seam_along(CircleCurve{30}, 250, closed);
        const SeamModel model = model_of(seam);
        const ArcLength arc(model.curve);
        EXPECT_NEAR(model.length_mm, arc.length(), 1e-9);
        ASSERT_EQ(model.flanks.size(), seam.points.size());
        for (std::size_t i = 0; i < model.flanks.size(); ++i) {
            const FlankSample& flank = model.flanks[i];
            if (i > 0) {
                EXPECT_GT(flank.station_mm, model.flanks[i - 1].station_mm);
            }
            const Vector3d p = position(model.curve, arc.parameter(flank.station_mm));
            const Vector3d n1 = flank.n1.cross(flank.n2);
            EXPECT_GT(n1.dot(tangent(model.curve, arc.parameter(flank.station_mm))), 0.99)
                << "station " << flank.station_mm;
            EXPECT_LT(p.z(), 0.02);
        }
    }
}

TEST(Fit, ResidualsAreTheDistancesOfThePoints) {
    const Seam seam = noisy(seam_along(SineCurve{200, 18}, 300, false), 0.03, 9);
    const SeamModel model = model_of(seam);
    double squares = 0, worst = 0;
    for (const SeamPoint& point : seam.points) {
        const double d = (position(model.curve, nearest_parameter(model.curve, point.p)) - point.p).norm();
        squares += d * d;
        worst = std::max(worst, d);
    }
    EXPECT_NEAR(model.residual_rms_mm, std::sqrt(squares / 300), 1e-3 * 0.03);
    EXPECT_NEAR(model.residual_max_mm, worst, 0.02 * worst);
}

TEST(Fit, IsTheSameWhenRepeated) {
    const Seam seam = noisy(seam_along(CircleCurve{30}, 250, true), 0.02, 10);
    const SeamModel one = model_of(seam), two = model_of(seam);
    ASSERT_EQ(one.curve.control.size(), two.curve.control.size());
    EXPECT_TRUE(std::equal(one.curve.control.begin(), one.curve.control.end(), two.curve.control.begin()));
    EXPECT_EQ(one.curve.knots, two.curve.knots);
}

TEST(Fit, RefusesFewPointsAndNoLength) {
    const Seam few = seam_along(Straight{{0, 0, 0}, {4, 0, 0}}, 5, false);
    EXPECT_THAT([&] { model_of(few); },
                testing::ThrowsMessage<InputError>(testing::StartsWith("fit: the seam has 5 points")));
    Seam one_place = seam_along(Straight{{0, 0, 0}, {4, 0, 0}}, 20, false);
    for (SeamPoint& point : one_place.points) {
        point.p = {1, 2, 3};
    }
    EXPECT_THAT([&] { model_of(one_place); },
                testing::ThrowsMessage<InputError>(testing::StartsWith("fit: the seam has no length")));
}

}  // namespace fit_test
}  // namespace seampath
