#include "stages/fit/interpolated.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/error.hpp"
#include "stages/geometry/interpolate.hpp"
#include "stages/plan/plan.hpp"
#include "tests/fit/models.hpp"

namespace seampath {
namespace interpolated_test {

using Eigen::Vector3d;
using testing::HasSubstr;
using enum FitModel;

const std::vector<FitModel> kOpen{natural, clamped,    not_a_knot,     akima,           pchip,
                                  linear,  parametric, newton_forward, newton_backward, stirling,
                                  bessel,  lagrange,   newton_divided};
const std::vector<FitModel> kClosed{periodic,        akima,    pchip,  linear,   parametric,    newton_forward,
                                    newton_backward, stirling, bessel, lagrange, newton_divided};

FitOptions with(FitModel model, FitAxis axis = FitAxis::length) {
    FitOptions options;
    options.model = model;
    options.axis = axis;
    return options;
}

/// Every so many-th point, an open seam's last among them.
Nodes every(const Seam& seam, std::size_t step) {
    Nodes nodes;
    for (std::size_t i = 0; i < seam.points.size(); i += step) {
        nodes.index.push_back(i);
    }
    return nodes;
}

/// Some far, some near.
Nodes uneven(const Seam& seam) {
    Nodes nodes;
    for (std::size_t i = 0, k = 0; i < seam.points.size(); i += 7 + 9 * (k++ % 3)) {
        nodes.index.push_back(i);
    }
    if (!seam.closed && nodes.index.back() + 1 != seam.points.size()) {
        nodes.index.push_back(seam.points.size() - 1);
    }
    return nodes;
}

/// A space curve without an axis along which it turns back but y.
struct Wave {
    Vector3d operator()(double x) const { return {120 * x, 9 * std::sin(2 * kPi * x), 30 * x + 4 * std::sin(5 * x)}; }
};

/// y is a polynomial of degree 5 in x, z one of degree 3.
struct Polynomial {
    double quintic;
    Vector3d operator()(double s) const {
        const double x = 2 * s - 1;
        return {-60 * x, 20 * x * (1 - x * x) + quintic * x * x * x * x * x, 5 * x * x - 8 * x * x * x};
    }
};

struct Ellipse {
    double a, b;
    Vector3d operator()(double x) const {
        return {a * std::cos(2 * kPi * x), b * std::sin(2 * kPi * x), 3 * std::sin(4 * kPi * x)};
    }
};

TEST(Interpolated, PassesTheNodes) {
    const Seam wave = seam_along(Wave{}, 201, false), ring = seam_along(Ellipse{40, 25}, 200, true);
    for (const auto& [seam, models] : {std::pair(wave, kOpen), std::pair(ring, kClosed)}) {
        for (const FitModel model : models) {
            if (sets_nodes(model)) {
                continue;
            }
            const Nodes nodes = uneven(seam);
            const SeamModel fitted = fit(seam, nodes, with(model));
            for (const std::size_t i : nodes.index) {
                const Vector3d& p = seam.points[i].p;
                EXPECT_LT((position(fitted.curve, nearest_parameter(fitted.curve, p)) - p).norm(), 1e-9)
                    << name(model) << " at point " << i;
            }
            EXPECT_EQ(fitted.degrees_of_freedom, 3.0 * static_cast<double>(nodes.index.size())) << name(model);
        }
    }
}

/// Held against the same method for one coordinate at a time, over lengths added up here.
TEST(Interpolated, IsTheMethodItself) {
    const Seam seam = seam_along(Wave{}, 201, false);
    const Nodes nodes = uneven(seam);
    std::vector<double> s, x, y, z;
    double length = 0;
    for (std::size_t i = 0; i < seam.points.size(); ++i) {
        length += i > 0 ? (seam.points[i].p - seam.points[i - 1].p).norm() : 0;
        if (std::find(nodes.index.begin(), nodes.index.end(), i) != nodes.index.end()) {
            s.push_back(length);
            x.push_back(seam.points[i].p.x());
            y.push_back(seam.points[i].p.y());
            z.push_back(seam.points[i].p.z());
        }
    }
    for (const auto& [model, method] :
         {std::pair(natural, Method::natural), std::pair(clamped, Method::clamped),
          std::pair(not_a_knot, Method::not_a_knot), std::pair(akima, Method::akima), std::pair(pchip, Method::pchip),
          std::pair(linear, Method::linear), std::pair(lagrange, Method::newton_divided),
          std::pair(newton_divided, Method::lagrange)}) {
        const SeamModel fitted = fit(seam, nodes, with(model));
        const Interpolant fx = interpolate(method, s, x, {}), fy = interpolate(method, s, y, {}),
                          fz = interpolate(method, s, z, {});
        const double tolerance = model == lagrange || model == newton_divided ? kPolynomialTolerance_mm : 1e-10;
        for (int k = 0; k <= 1000; ++k) {
            const double at = std::min(length * k / 1000, s.back());
            const Vector3d expected(fx.value(at), fy.value(at), fz.value(at));
            ASSERT_LT((position(fitted.curve, at) - expected).norm(), tolerance) << name(model) << " at " << at;
        }
    }
}

// Newton I, II and Bessel differ in the nodes that they take: over nodes of one polynomial they are that polynomial.
TEST(Interpolated, PolynomialsComeOut) {
    for (const double quintic : {0.0, 12.0}) {
        const Seam seam = seam_along(Polynomial{quintic}, 601, false);
        std::vector<FitModel> models{newton_forward, newton_backward, bessel, lagrange, newton_divided};
        if (quintic == 0) {
            models.insert(models.end(), {not_a_knot, stirling});
        }
        for (const FitModel model : models) {
            const SeamModel fitted = fit(seam, every(seam, 60), with(model, FitAxis::x));
            // Akima's line through points 0.2 mm apart is that near.
            EXPECT_LT(largest_error(fitted, Polynomial{quintic}), sets_nodes(model) ? 2e-5 : 1.1e-6) << name(model);
        }
    }
    const Seam seam = seam_along(Polynomial{12}, 601, false);
    EXPECT_GT(largest_error(fit(seam, every(seam, 60), with(natural, FitAxis::x)), Polynomial{12}), 0.01);
    FitOptions low = with(lagrange, FitAxis::x);
    low.degree = 3;
    const double cubic = largest_error(fit(seam, every(seam, 60), low), Polynomial{12});
    EXPECT_GT(cubic, 1e-3);
    low.degree = 4;
    EXPECT_EQ(largest_error(fit(seam, every(seam, 60), low), Polynomial{12}), cubic) << "Lagrange's degree is odd";
}

// Of degree 2 the blend of Stirling's formulas is Overhauser's curve (1968): Hermite's cubics with central differences
// as slopes.
TEST(Interpolated, StirlingOfDegreeTwoIsOverhausers) {
    const Polynomial course{12};
    const Seam seam = seam_along(course, 601, false);
    FitOptions two = with(stirling, FitAxis::x);
    two.degree = 2;
    const SeamModel fitted = fit(seam, every(seam, 60), two);
    // x is linear in the parameter, so nodes at equal steps of x are those of the course.
    std::vector<Vector3d> p;
    for (int k = 0; k <= 10; ++k) {
        p.push_back(course(0.1 * k));
    }
    for (std::size_t k = 1; k + 2 < p.size(); ++k) {
        const Vector3d m0 = 0.5 * (p[k + 1] - p[k - 1]), m1 = 0.5 * (p[k + 2] - p[k]);
        for (int i = 0; i <= 10; ++i) {
            const double u = 0.1 * i, u2 = u * u, u3 = u2 * u;
            const Vector3d expected =
                (2 * u3 - 3 * u2 + 1) * p[k] + (u3 - 2 * u2 + u) * m0 + (3 * u2 - 2 * u3) * p[k + 1] + (u3 - u2) * m1;
            EXPECT_LT((position(fitted.curve, nearest_parameter(fitted.curve, expected)) - expected).norm(), 2e-5);
        }
    }
}

TEST(Interpolated, StirlingDoesNotJumpOrKink) {
    const Seam seam = seam_along(Wave{}, 401, false);
    const SeamModel fitted = fit(seam, every(seam, 40), with(stirling));
    Vector3d before = tangent(fitted.curve, first_parameter(fitted.curve));
    const double length = last_parameter(fitted.curve);
    for (int k = 1; k <= 20000; ++k) {
        const Vector3d now = tangent(fitted.curve, length * k / 20000);
        EXPECT_LT((now - before).norm(), 0.005) << k;
        before = now;
    }
    EXPECT_LT(largest_error(fitted, Wave{}), 0.3);
    FitOptions one = with(stirling);
    one.degree = 1;
    FitOptions newton = with(newton_forward);
    newton.degree = 1;
    EXPECT_EQ(fit(seam, every(seam, 40), one).length_mm, fit(seam, every(seam, 40), newton).length_mm)
        << "there is no formula of degree 0";
}

// Over nodes at equal steps the error of a spline is |f''''| h^4 / 384 to the leading order (Hall & Meyer 1976).
TEST(Interpolated, ErrorOnACircleIsTheOneKnown) {
    constexpr double kRadius = 30;
    const Seam seam = seam_along(CircleCurve{kRadius}, 2400, true);
    for (const std::size_t n : {16u, 24u}) {
        const double expected = kRadius * std::pow(2 * kPi / static_cast<double>(n), 4) / 384;
        for (const FitModel model : {periodic, parametric}) {
            EXPECT_NEAR(largest_error(fit(seam, every(seam, 2400 / n), with(model)), CircleCurve{kRadius}) / expected,
                        1, 0.1)
                << name(model) << ", " << n << " nodes";
        }
        const double sagitta = kRadius * (1 - std::cos(kPi / static_cast<double>(n)));
        EXPECT_NEAR(largest_error(fit(seam, every(seam, 2400 / n), with(linear)), CircleCurve{kRadius}) / sagitta, 1,
                    0.01);
    }
}

TEST(Interpolated, ClosedSeamsHaveNoBeginning) {
    for (const FitModel model : kClosed) {
        // Equal steps from another point are the same places on a circle only.
        const Seam seam =
            sets_nodes(model) ? seam_along(CircleCurve{30}, 240, true) : seam_along(Ellipse{40, 25}, 240, true);
        Seam turned = seam;
        std::rotate(turned.points.begin(), turned.points.begin() + 96, turned.points.end());
        const SeamModel a = fit(seam, every(seam, 24), with(model)), b = fit(turned, every(seam, 24), with(model));
        const ArcLength along(a.curve);
        for (int k = 0; k < 100; ++k) {
            const Vector3d p = position(a.curve, along.parameter(along.length() * k / 100));
            ASSERT_LT((position(b.curve, nearest_parameter(b.curve, p)) - p).norm(), 1e-6) << name(model);
        }
        EXPECT_NEAR(a.length_mm, b.length_mm, 1e-6) << name(model);
    }
}

TEST(Interpolated, ParametersAreMarins) {
    const Seam seam = seam_along(Wave{}, 201, false);
    const Nodes nodes = uneven(seam);
    std::vector<Eigen::VectorXd> points;
    for (const std::size_t i : nodes.index) {
        points.emplace_back(seam.points[i].p);
    }
    for (const Objective objective :
         {Objective::chord, Objective::centripetal, Objective::foley, Objective::exact, Objective::diagonal}) {
        FitOptions options = with(parametric);
        options.parametrization = objective;
        const CubicBSpline curve = fit(seam, nodes, options).curve;
        const auto t = parametrize(points, {objective, Solver::lbfgs, {}, {}}).t;
        ASSERT_EQ(curve.knots.size(), t.size() + 6);
        for (std::size_t k = 0; k < t.size(); ++k) {
            EXPECT_NEAR(curve.knots[k + 3] / curve.knots.back(), t[k], 1e-12) << name(objective);
            EXPECT_LT((position(curve, curve.knots[k + 3]) - points[k]).norm(), 1e-10) << name(objective);
        }
    }
}

// By symmetry all steps of a regular ring are equal, whatever is made least.
TEST(Interpolated, ParametersOfARingKnowNoEnds) {
    const Seam seam = seam_along(CircleCurve{30}, 240, true);
    for (const Objective objective :
         {Objective::centripetal, Objective::foley, Objective::exact, Objective::diagonal}) {
        FitOptions options = with(parametric);
        options.parametrization = objective;
        const auto knots = fit(seam, every(seam, 20), options).curve.knots;
        ASSERT_EQ(knots.size(), 13u);
        for (std::size_t k = 1; k < knots.size(); ++k) {
            EXPECT_NEAR((knots[k] - knots[k - 1]) / knots.back(), 1 / 12.0, 2e-4) << name(objective) << " " << k;
        }
    }
}

TEST(Interpolated, FollowsAnAxisEitherWay) {
    const Seam seam = seam_along(Polynomial{0}, 601, false);  // x falls
    Seam back = seam;
    std::reverse(back.points.begin(), back.points.end());
    const SeamModel a = fit(seam, every(seam, 60), with(natural, FitAxis::x)),
                    b = fit(back, every(back, 60), with(natural, FitAxis::x));
    EXPECT_EQ(position(a.curve, first_parameter(a.curve)), seam.points.front().p);
    EXPECT_EQ(position(b.curve, first_parameter(b.curve)), seam.points.back().p);
    EXPECT_NEAR(a.length_mm, b.length_mm, 1e-9);
    EXPECT_NEAR(a.residual_max_mm, b.residual_max_mm, 1e-9);
}

TEST(Interpolated, IsPlannedLikeAnyModel) {
    const Seam wave = seam_along(Wave{}, 201, false), ring = seam_along(Ellipse{40, 25}, 200, true);
    for (const auto& [seam, models] : {std::pair(wave, kOpen), std::pair(ring, kClosed)}) {
        for (const FitModel model : models) {
            const std::vector<SeamModel> fitted{fit(seam, every(seam, 8), with(model))};
            PlanOptions options;
            if (model == linear) {
                EXPECT_THAT([&] { plan(fitted, options); },
                            testing::ThrowsMessage<InputError>(HasSubstr("the torch direction jumps")));
            }
            if (model == linear || model == newton_forward || model == newton_backward) {
                options.max_turn_deg = 30;  // their lines have corners at the nodes
            }
            Plan travel;
            ASSERT_NO_THROW(travel = plan(fitted, options)) << name(model) << (seam.closed ? ", closed" : ", open");
            EXPECT_LE(travel.max_chord_error_mm, options.chord_tolerance_mm) << name(model);
            EXPECT_EQ(fitted[0].flanks.size(), seam.points.size()) << name(model);
        }
    }
}

TEST(Interpolated, SaysWhyAModelCantServeTheSeam) {
    const Seam open = seam_along(Wave{}, 101, false), ring = seam_along(Ellipse{40, 25}, 100, true);
    Seam still = open;
    still.points[10].p = still.points[11].p;
    FitOptions centripetal = with(natural);
    centripetal.parametrization = Objective::centripetal;
    struct Case {
        const Seam& seam;
        FitOptions options;
        const char* message;
    };
    const std::vector<Case> cases{
        {open, with(periodic), "fit.model \"periodic\" is for closed seams, and this one has two ends"},
        {ring, with(natural), "fit.model \"natural\" is for a line with two ends, and the seam is closed"},
        {ring, with(not_a_knot), "\"not-a-knot\" is for a line with two ends"},
        {ring, with(akima, FitAxis::z), "fit.axis z: a closed seam turns back along every axis"},
        {open, with(natural, FitAxis::y), "fit.axis y: the seam is no function of y: from node "},
        {open, with(parametric, FitAxis::x), "the parametric model follows the seam's length"},
        {open, with(spline, FitAxis::x), "fit.axis is for models that interpolate; fit.model is spline"},
        {open, centripetal, "fit.parametrization is for the parametric model; fit.model is natural"},
        {still, with(natural), "from node 10 to node 11"},
        {still, with(bessel), "from node 10 to node 11"}};
    for (const Case& c : cases) {
        const Nodes nodes = every(c.seam, &c.seam == &still ? 1 : 10);
        EXPECT_THAT([&] { fit(c.seam, nodes, c.options); }, testing::ThrowsMessage<InputError>(HasSubstr(c.message)));
    }
    EXPECT_THAT([&] { fit(ring, every(ring, 50), with(periodic)); },
                testing::ThrowsMessage<InputError>(HasSubstr("has 2 nodes; at least 3 were needed")));
}

TEST(Interpolated, FewNodesDo) {
    const Seam open = seam_along(Wave{}, 101, false), ring = seam_along(Ellipse{40, 25}, 99, true);
    for (const FitModel model : kOpen) {
        for (const std::size_t step : {100u, 50u, 25u}) {
            EXPECT_GT(fit(open, every(open, step), with(model)).length_mm, 120) << name(model) << " " << step;
        }
    }
    for (const FitModel model : kClosed) {
        EXPECT_GT(fit(ring, every(ring, 33), with(model)).length_mm, 100) << name(model);
    }
}

}  // namespace interpolated_test
}  // namespace seampath
