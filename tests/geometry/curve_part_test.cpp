#include "stages/geometry/curve_part.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "stages/geometry/bspline.hpp"
#include "tests/plan/models.hpp"

namespace seampath {
namespace curve_part_test {

using Eigen::Vector3d;

CubicBSpline open_curve() {
    CubicBSpline curve = test::model_of(test::helix(35, 30), false, 20).curve;
    curve.knots[8] = curve.knots[7];  // a joint with one derivative only
    return curve;
}

CubicBSpline ring() {
    return test::model_of(test::rounded_box(80, 20), true, 24).curve;
}

TEST(CurvePart, ReversedRunsTheOtherWay) {
    for (const CubicBSpline& curve : {open_curve(), ring()}) {
        const CubicBSpline back = reversed(curve);
        const double first = first_parameter(curve), last = last_parameter(curve);
        for (int k = 1; k < 1000; ++k) {
            const double u = first + (last - first) * k / 1000;
            EXPECT_LT((position(back, first + last - u) - position(curve, u)).norm(), 1e-11) << k;
            EXPECT_LT((derivative(back, first + last - u) + derivative(curve, u)).norm(), 1e-11) << k;
        }
    }
}

TEST(CurvePart, IsTheSameCurve) {
    const CubicBSpline open = open_curve(), closed = ring();
    const double length = last_parameter(open), period = last_parameter(closed);
    struct Part {
        const CubicBSpline& curve;
        double from, to;
    };
    const Part parts[] = {
        {open, 0, length},   {open, 0.21 * length, 0.83 * length}, {open, open.knots[7], open.knots[12]},
        {closed, 0, period}, {closed, 0.4 * period, 1.4 * period}, {closed, 0.9 * period, 3.2 * period}};
    for (const auto& [curve, from, to] : parts) {
        const CubicBSpline part = part_of(curve, from, to);
        EXPECT_FALSE(part.periodic);
        EXPECT_NEAR(first_parameter(part), from, 1e-12 * to);
        EXPECT_NEAR(last_parameter(part), to, 1e-12 * to);
        for (int k = 1; k < 1000; ++k) {
            const double u = from + (to - from) * k / 1000;
            EXPECT_LT((position(part, u) - position(curve, u)).norm(), 1e-10) << k;
            EXPECT_LT((second_derivative(part, u) - second_derivative(curve, u)).norm(), 1e-8) << k;
        }
    }
}

TEST(CurvePart, GoesStraightOnAtItsEnds) {
    const CubicBSpline curve = open_curve();
    const double from = 0.3 * last_parameter(curve), to = 0.7 * last_parameter(curve);
    const CubicBSpline part = part_of(curve, from, to, 12, 5);
    const Vector3d start = position(curve, from), end = position(curve, to);
    const Vector3d out = tangent(curve, from), on = tangent(curve, to);
    const double first = first_parameter(part), last = last_parameter(part);
    EXPECT_LT((position(part, first) - (start - 12 * out)).norm(), 1e-10);
    EXPECT_LT((position(part, last) - (end + 5 * on)).norm(), 1e-10);
    for (int k = 0; k < 50; ++k) {
        const double before = first + (from - first) * k / 50;
        EXPECT_LT((start - position(part, before)).cross(out).norm(), 1e-10);
        EXPECT_LT((tangent(part, before) - out).norm(), 1e-10);
        const double u = from + (to - from) * (k + 0.5) / 50;
        EXPECT_LT((position(part, u) - position(curve, u)).norm(), 1e-10);
    }
    EXPECT_NEAR(ArcLength(part).length(), 17 + ArcLength(curve).station(to) - ArcLength(curve).station(from), 1e-9);
}

TEST(CurvePart, PartsJoinToTheSameCurveAgain) {
    const CubicBSpline open = open_curve(), closed = ring();
    for (const CubicBSpline& curve : {open, closed}) {
        const double first = first_parameter(curve), length = last_parameter(curve) - first;
        std::vector<CubicBSpline> parts;
        const double at[] = {0, 0.13, 0.5, 0.77, 1};
        for (std::size_t k = 0; k < 4; ++k) {
            parts.push_back(part_of(curve, first + at[k] * length, first + at[k + 1] * length));
        }
        const CubicBSpline whole = joined(parts, curve.periodic);
        EXPECT_EQ(whole.periodic, curve.periodic);
        for (int k = 1; k < 1000; ++k) {
            const double u = first + length * k / 1000;
            EXPECT_LT((position(whole, u) - position(curve, u)).norm(), 1e-9) << k;
            EXPECT_LT((derivative(whole, u) - derivative(curve, u)).norm(), 1e-9) << k;
        }
        std::size_t corners = 0;
        for (const CurveKnot& knot : knots_of(whole)) {
            corners += knot.continuity == 0;
        }
        EXPECT_EQ(corners, curve.periodic ? 4u : 3u);
    }
}

}  // namespace curve_part_test
}  // namespace seampath
