#include "stages/geometry/pieces.hpp"

#include <gtest/gtest.h>

#include "stages/geometry/bspline.hpp"
#include "tests/geometry/curves.hpp"

namespace seampath {
namespace pieces_test {

/// Taylor's cubics of a spline between its knots; a knot's multiplicity says what its pieces share.
CubicPieces pieces_of(const CubicBSpline& curve) {
    CubicPieces pieces;
    const double first = first_parameter(curve), last = last_parameter(curve);
    for (const double knot : curve.knots) {
        const bool repeated = !pieces.breaks.empty() && knot == pieces.breaks.back();
        if (repeated && knot < last && !pieces.joints.empty()) {
            pieces.joints.back() = static_cast<Joint>(pieces.joints.back() + 1);
        }
        if (repeated || knot < first || knot > last) {
            continue;
        }
        pieces.breaks.push_back(knot);
        if (knot == last) {
            break;
        }
        pieces.joints.push_back(kTwoDerivatives);
    }
    for (std::size_t k = 0; k + 1 < pieces.breaks.size(); ++k) {
        const double from = pieces.breaks[k], h = pieces.breaks[k + 1] - from;
        const Eigen::Vector3d second = second_derivative(curve, from), middle = second_derivative(curve, from + h / 2);
        pieces.coefficients.push_back(
            {position(curve, from), derivative(curve, from), second / 2, (middle - second) / h / 3});
    }
    return pieces;
}

void expect_back(const CubicBSpline& curve) {
    const CubicBSpline back = as_bspline(pieces_of(curve), curve.periodic);
    EXPECT_EQ(back.knots, curve.knots);
    ASSERT_EQ(back.control.size(), curve.control.size());
    for (std::size_t i = 0; i < curve.control.size(); ++i) {
        EXPECT_LT((back.control[i] - curve.control[i]).norm(), 1e-11) << "control point " << i;
    }
}

TEST(Pieces, GiveBackTheSplineThatTheyAreCutFrom) {
    expect_back(open_spline());
    expect_back(closed_spline());
}

TEST(Pieces, WithKnotsOfAnyMultiplicity) {
    CubicBSpline open = open_spline();
    open.knots = {0, 0, 0, 0, 7, 7, 22, 55, 55, 55, 55};
    open.control.pop_back();
    expect_back(open);
    open.knots = {0, 0, 0, 0, 22, 22, 22, 55, 55, 55, 55};
    expect_back(open);
    CubicBSpline closed = closed_spline();
    closed.knots = {0, 0, 15, 21, 21, 40, 52};
    expect_back(closed);
    closed.knots = {0, 0, 0, 21, 21, 21, 52};
    expect_back(closed);
}

TEST(Pieces, OneCubicIsABezierCurve) {
    const CubicPieces pieces{{2, 5}, {{{{1, 2, 3}, {1, 0, -1}, {0.5, 0.25, 0}, {0.1, 0, 0.2}}}}, {kTwoDerivatives}};
    const CubicBSpline curve = as_bspline(pieces, false);
    for (const double v : {0.0, 1.0, 2.5, 3.0}) {
        const auto& c = pieces.coefficients[0];
        EXPECT_LT((position(curve, 2 + v) - (c[0] + v * (c[1] + v * (c[2] + v * c[3])))).norm(), 1e-13);
    }
}

}  // namespace pieces_test
}  // namespace seampath
