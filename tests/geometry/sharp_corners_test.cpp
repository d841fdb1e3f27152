#include "stages/geometry/corners.hpp"

#include <gtest/gtest.h>

#include "datasets/rng.hpp"
#include "stages/geometry/bspline.hpp"
#include "tests/geometry/curves.hpp"

namespace seampath {
namespace sharp_corners_test {

using Eigen::Vector3d;

const std::vector<Vector3d> kBox{{0, 0, 0}, {120, 0, 0}, {120, 70, 0}, {0, 70, 0}};
constexpr double kAround = 380;

/// Points once round the sharp box, none nearer to a corner than `gap`; from the middle of the first side on.
CurvePoints box_points(double spacing, double gap, double sigma, std::uint64_t seed) {
    const Random random(seed, 0);
    CurvePoints points;
    std::uint64_t k = 0;
    const auto along = [&](const Vector3d& from, const Vector3d& to) {
        const Vector3d d = (to - from).normalized(), across = d.cross(Vector3d::UnitZ());
        for (double s = 0.5 * spacing; s < (to - from).norm(); s += spacing, k += 2) {
            points.p.push_back(from + s * d +
                               sigma / std::sqrt(2.0) *
                                   (random.normal(k) * across + random.normal(k + 1) * Vector3d::UnitZ()));
            points.weight.push_back(std::pow(std::max(sigma, 1e-3), -2));
        }
    };
    along({60, 0, 0}, {120 - gap, 0, 0});
    along({120, gap, 0}, {120, 70 - gap, 0});
    along({120 - gap, 70, 0}, {gap, 70, 0});
    along({0, 70 - gap, 0}, {0, gap, 0});
    along({gap, 0, 0}, {60, 0, 0});
    points.u.assign(points.p.size(), 0);
    return points;
}

double from_box(const Vector3d& p) {
    double least = 1e9;
    for (std::size_t k = 0; k < 4; ++k) {
        const Vector3d a = kBox[k], b = kBox[(k + 1) % 4];
        const double x = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
        least = std::min(least, (a + x * (b - a) - p).norm());
    }
    return least;
}

TEST(Corners, AreWhereTheSidesOfASharpBoxMeet) {
    for (const double gap : {0.0, 1.0, 2.5}) {
        for (const double sigma : {0.0, 0.005, 0.03}) {
            for (const std::uint64_t seed : {1, 2, 3}) {
                const auto corners = corners_of(box_points(1, gap, sigma, seed), true);
                ASSERT_EQ(corners.size(), 4u) << "gap " << gap << ", sigma " << sigma << ", seed " << seed;
                for (std::size_t k = 0; k < 4; ++k) {
                    EXPECT_LT((corners[k].p - kBox[(k + 1) % 4]).norm(), sigma + 1e-9) << "gap " << gap;
                }
            }
        }
    }
}

TEST(Corners, AreThoseOfTheCurve) {
    for (const double sigma : {0.0, 0.02}) {
        CurvePoints points = box_points(1, 2, sigma, 7);
        const FittedCurve fitted = smooth_pieces(points, true);
        double worst = 0, farthest = 0;
        for (int i = 0; i < 2000; ++i) {
            const double u = last_parameter(fitted.curve) * i / 2000;
            worst = std::max(worst, from_box(position(fitted.curve, u)));
        }
        for (const Vector3d& corner : kBox) {
            farthest =
                std::max(farthest, (position(fitted.curve, nearest_parameter(fitted.curve, corner)) - corner).norm());
        }
        EXPECT_LT(worst, sigma + 1e-6);
        EXPECT_LT(farthest, 1.5 * sigma + 1e-6);
        EXPECT_NEAR(ArcLength(fitted.curve).length(), kAround, 2 * sigma + 1e-6);
        int sharp = 0;
        for (const CurveKnot& knot : knots_of(fitted.curve)) {
            EXPECT_TRUE(knot.continuity == 2 || knot.continuity == 0);
            sharp += knot.continuity == 0 ? 1 : 0;
        }
        EXPECT_EQ(sharp, 4);
        for (std::size_t i = 0; i < points.p.size(); ++i) {
            EXPECT_LT((position(fitted.curve, points.u[i]) - points.p[i]).norm(), 4 * sigma + 1e-6);
        }
    }
}

TEST(Corners, OfAnOpenSeamLeaveItsEnds) {
    CurvePoints points;
    for (int i = 0; i <= 40; ++i) {
        points.p.emplace_back(i, 0, 0);
    }
    for (int i = 1; i <= 30; ++i) {
        points.p.emplace_back(40 + 0.6 * i, 0.8 * i, 0);  // 53 deg
    }
    points.weight.assign(points.p.size(), 1e6);
    points.u.assign(points.p.size(), 0);
    const FittedCurve fitted = smooth_pieces(points, false);
    EXPECT_LT((position(fitted.curve, 0) - points.p.front()).norm(), 1e-5);
    EXPECT_LT((position(fitted.curve, last_parameter(fitted.curve)) - points.p.back()).norm(), 1e-5);
    EXPECT_NEAR(ArcLength(fitted.curve).length(), 70, 1e-5);
}

// A bend of which there are points, noise and single points that are off are no corners.
TEST(Corners, AreNotSeenWhereThereAreNone) {
    const Random random(3, 0);
    for (const double radius : {2.0, 5.0, 30.0}) {
        for (const double noise : {0.0, 0.02, 0.05}) {
            CurvePoints points;
            for (int i = 0; i < 200; ++i) {
                const double s = i - 100.0, turn = 0.5 * kPi, arc = radius * turn;
                const double a = std::clamp(s / radius, 0.0, turn), before = std::min(s, 0.0),
                             behind = std::max(0.0, s - arc);
                const Vector3d p(before + radius * std::sin(a), radius * (1 - std::cos(a)) + behind, 0);
                const auto k = static_cast<std::uint64_t>(3 * i);
                points.p.push_back(p + noise * Vector3d(random.normal(k), random.normal(k + 1), random.normal(k + 2)));
                points.p.back().z() += i % 23 == 11 ? 40 * noise : 0;
                points.weight.push_back(1 / std::max(2 * noise * noise, 1e-6));
            }
            points.u.assign(points.p.size(), 0);
            EXPECT_TRUE(corners_of(points, false).empty()) << radius << ' ' << noise;
        }
    }
}

TEST(Knots, TellTheirContinuity) {
    CubicBSpline open = open_spline();
    open.knots = {0, 0, 0, 0, 7, 20, 20, 40, 55, 55, 55, 55};
    const auto knots = knots_of(open);
    ASSERT_EQ(knots.size(), 3u);
    EXPECT_EQ(knots[0].continuity, 2);
    EXPECT_EQ(knots[1].u, 20);
    EXPECT_EQ(knots[1].continuity, 1);
    EXPECT_EQ(knots[2].continuity, 2);
    EXPECT_EQ(knots_of(closed_spline()).size(), closed_spline().control.size());
}

}  // namespace sharp_corners_test
}  // namespace seampath
