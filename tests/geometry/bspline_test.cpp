#include "stages/geometry/bspline.hpp"

#include <gtest/gtest.h>

#include "datasets/rng.hpp"
#include "tests/geometry/curves.hpp"

namespace seampath {
namespace bspline_test {

using Eigen::Vector3d;

class SplineLaws : public testing::TestWithParam<bool> {
protected:
    CubicBSpline curve_ = GetParam() ? closed_spline() : open_spline();
    double first_ = first_parameter(curve_);
    double last_ = last_parameter(curve_);

    double parameter(int i, int count) const { return first_ + (last_ - first_) * (i + 0.5) / count; }
};
INSTANTIATE_TEST_SUITE_P(, SplineLaws, testing::Values(false, true),
                         [](const auto& which) { return which.param ? "closed" : "open"; });

TEST_P(SplineLaws, BasisIsAPartitionOfUnity) {
    for (int i = 0; i < 500; ++i) {
        const CubicBasis basis = cubic_basis(curve_.knots, curve_.control.size(), curve_.periodic, parameter(i, 500));
        double value = 0, d1 = 0, d2 = 0;
        for (int k = 0; k < 4; ++k) {
            EXPECT_GE(basis.value[k], -1e-15);
            value += basis.value[k], d1 += basis.d1[k], d2 += basis.d2[k];
        }
        EXPECT_NEAR(value, 1, 1e-14);
        EXPECT_NEAR(d1, 0, 1e-13);
        EXPECT_NEAR(d2, 0, 1e-13);
    }
}

TEST_P(SplineLaws, DerivativesEqualDifferences) {
    constexpr double kStep = 1e-4;
    for (int i = 0; i < 200; ++i) {
        const double u = parameter(i, 200);
        const Vector3d before = position(curve_, u - kStep), here = position(curve_, u),
                       behind = position(curve_, u + kStep);
        EXPECT_LT((derivative(curve_, u) - (behind - before) / (2 * kStep)).norm(), 1e-7) << "u = " << u;
        EXPECT_LT((second_derivative(curve_, u) -
                   (derivative(curve_, u + kStep) - derivative(curve_, u - kStep)) / (2 * kStep))
                      .norm(),
                  2e-4)
            << "u = " << u;
        EXPECT_LT((behind - here).norm(), 1.5 * kStep * (derivative(curve_, u).norm() + 0.1));
    }
}

TEST_P(SplineLaws, PositionAndTwoDerivativesGoOnAcrossKnots) {
    for (const double knot : curve_.knots) {
        if (!curve_.periodic && (knot == first_ || knot == last_)) {
            continue;
        }
        constexpr double kNear = 1e-9;
        EXPECT_LT((position(curve_, knot - kNear) - position(curve_, knot + kNear)).norm(), 1e-7);
        EXPECT_LT((derivative(curve_, knot - kNear) - derivative(curve_, knot + kNear)).norm(), 1e-7);
        EXPECT_LT((second_derivative(curve_, knot - kNear) - second_derivative(curve_, knot + kNear)).norm(), 1e-7);
    }
}

TEST_P(SplineLaws, ArcLengthIsThatOfAFinePolylineAndInverts) {
    const ArcLength arc(curve_);
    constexpr int kPieces = 200000;
    double length = 0;
    Vector3d before = position(curve_, first_);
    for (int i = 1; i <= kPieces; ++i) {
        const Vector3d here =
            position(curve_, i == kPieces && curve_.periodic ? first_ : first_ + (last_ - first_) * i / kPieces);
        length += (here - before).norm();
        before = here;
    }
    EXPECT_NEAR(arc.length(), length, 1e-7);
    double station_before = 0;
    for (int i = 0; i < 1000; ++i) {
        const double u = parameter(i, 1000);
        const double station = arc.station(u);
        EXPECT_GT(station, station_before);
        EXPECT_NEAR(arc.parameter(station), u, 1e-9);
        station_before = station;
    }
    EXPECT_NEAR(arc.station(first_), 0, 1e-12);
}

TEST_P(SplineLaws, NearestPointIsNotBeatenByBruteForce) {
    const Random random(3, 0);
    for (std::uint64_t i = 0; i < 300; ++i) {
        const double u = random.uniform(10 * i, first_, last_);
        const double reach = random.uniform(10 * i + 1, 0, 8);
        const Vector3d p =
            position(curve_, u) +
            reach *
                Vector3d(random.normal(10 * i + 2), random.normal(10 * i + 3), random.normal(10 * i + 4)).normalized();
        const double distance = (position(curve_, nearest_parameter(curve_, p)) - p).norm();
        double brute = 1e9;
        for (int k = 0; k <= 5000; ++k) {
            brute = std::min(brute, (position(curve_, first_ + (last_ - first_) * k / 5000) - p).norm());
        }
        EXPECT_LE(distance, brute + 1e-9) << "point " << i;
    }
}

TEST(Spline, OpenCurveRunsFromItsFirstControlPointToItsLast) {
    const CubicBSpline curve = open_spline();
    EXPECT_LT((position(curve, first_parameter(curve)) - curve.control.front()).norm(), 1e-12);
    EXPECT_LT((position(curve, last_parameter(curve)) - curve.control.back()).norm(), 1e-12);
}

TEST(Spline, LengthAndCurvatureOfACircle) {
    const CubicBSpline circle = circle_spline(25, 64);
    EXPECT_NEAR(ArcLength(circle).length(), 2 * kPi * 25, 2 * kPi * 25 * std::pow(2 * kPi / 64, 4) / 500);
    for (int i = 0; i < 64; ++i) {
        EXPECT_NEAR(curvature(circle, circle.knots[static_cast<std::size_t>(i)]), 1.0 / 25, 1e-4);
    }
}

TEST(Spline, StationsOfAClosedCurveWrapAndOfAnOpenOneStop) {
    const ArcLength closed(closed_spline()), open(open_spline());
    EXPECT_NEAR(closed.parameter(closed.length() + 3), closed.parameter(3), 1e-9);
    EXPECT_NEAR(closed.parameter(-3), closed.parameter(closed.length() - 3), 1e-9);
    EXPECT_DOUBLE_EQ(open.parameter(-3), first_parameter(open.curve()));
    EXPECT_DOUBLE_EQ(open.parameter(open.length() + 3), last_parameter(open.curve()));
}

TEST(Spline, NearestPointOfACircleFromItsStart) {
    const CubicBSpline circle = circle_spline(25, 64);
    const ArcLength arc(circle);
    for (int i = 0; i < 100; ++i) {
        const double a = 2 * kPi * i / 100;
        const double u =
            nearest_parameter(circle, Vector3d(20 * std::cos(a), 20 * std::sin(a), 4), arc.parameter(25 * a + 1));
        EXPECT_LT((position(circle, u) - 25 * Vector3d(std::cos(a), std::sin(a), 0)).norm(), 1e-4);
    }
}

/// Flanks at three stations of a seam of length 100.
SeamModel three_flanks(bool closed) {
    const auto turned = [](double degrees) {
        return Vector3d(0, std::cos(degrees * kPi / 180), std::sin(degrees * kPi / 180));
    };
    SeamModel model;
    model.closed = closed;
    model.length_mm = 100;
    model.flanks = {{10, turned(0), turned(90), 0.01, false},
                    {40, turned(20), turned(90), 0.03, false},
                    {90, turned(40), turned(90), 0.02, true}};
    return model;
}

TEST(Flanks, LieBetweenTheirNeighbours) {
    const FlankSample middle = flanks_at(three_flanks(false), 25);
    EXPECT_NEAR(std::atan2(middle.n1.z(), middle.n1.y()), 10 * kPi / 180, 1e-12);
    EXPECT_NEAR(middle.n1.norm(), 1, 1e-15);
    EXPECT_NEAR(middle.sigma_mm, 0.02, 1e-15);
    EXPECT_FALSE(middle.modelled);
    EXPECT_TRUE(flanks_at(three_flanks(false), 80).modelled);
}

TEST(Flanks, StayBeyondOpenEndsAndWrapRoundClosedSeams) {
    EXPECT_DOUBLE_EQ(flanks_at(three_flanks(false), 2).sigma_mm, 0.01);
    EXPECT_DOUBLE_EQ(flanks_at(three_flanks(false), 99).sigma_mm, 0.02);
    EXPECT_NEAR(flanks_at(three_flanks(true), 0).sigma_mm, 0.015, 1e-15);
    EXPECT_NEAR(flanks_at(three_flanks(true), 95).sigma_mm, 0.0175, 1e-15);
    EXPECT_NEAR(flanks_at(three_flanks(true), 195).sigma_mm, 0.0175, 1e-15);
}

}  // namespace bspline_test
}  // namespace seampath
