#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/error.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/geometry/pose.hpp"
#include "stages/nominal/nominal.hpp"
#include "stages/plan/plan.hpp"
#include "stages/text.hpp"
#include "tests/papers/saddles.hpp"
#include "tests/papers/tables.hpp"

/// Xue et al. 2018, its figures and what holds for saddles in general position.
namespace seampath {
namespace saddle_test {

using Eigen::Vector3d;
using testing::HasSubstr;

constexpr double kPi = std::numbers::pi;

double degrees(double rad) {
    return rad * 180 / kPi;
}

TEST(Xue, Table1ComesOutToEveryPrintedDigit) {
    const SaddleCurve curve = pipes(600, 150);
    const auto angles = step_angles(curve, StepLaw::equal_angle, curve.length() / 40);
    const auto printed = read_table(paper_file("xue_table_1.csv")).rows;
    ASSERT_EQ(printed.size(), 41u);
    ASSERT_EQ(angles.size(), printed.size());
    for (std::size_t i = 0; i < angles.size(); ++i) {
        const SaddlePoint s = curve.at(angles[i]);
        const double delta = torch_angle(s, PoseLaw::paper, kPi / 4);
        const std::array<double, 5> values{s.theta, s.p.x(), s.p.y(), s.p.z(), delta};
        for (std::size_t k = 0; k < values.size(); ++k) {
            EXPECT_EQ(fixed(values[k], 4), fixed(printed[i].at(k), 4)) << "row " << i + 1 << " column " << k + 1;
        }
    }
}

TEST(Xue, Table1IsOfEqualAnglesNotOfEqualArcs) {
    const SaddleCurve curve = pipes(600, 150);
    double least = 1e9, most = 0;
    for (int i = 0; i < 40; ++i) {
        const double arc = curve.station(kPi * (i + 1) / 20) - curve.station(kPi * i / 20);
        least = std::min(least, arc);
        most = std::max(most, arc);
    }
    EXPECT_NEAR(least, 23.568, 5e-4);
    EXPECT_NEAR(most, 23.746, 5e-4);
}

// (23) as printed, away from its pole.
TEST(Xue, VariableAngleLawIsThePapers) {
    const double R = 600, r = 150;
    const SaddleCurve curve = pipes(R, r);
    for (const double theta : {0.1, 0.7, 1.4, 2.0, 3.5, 5.9}) {
        const double x = r * std::sin(theta), tangent2 = std::pow(std::tan(theta), 2);
        const double sine = std::sqrt(1 + tangent2) / std::sqrt(x * x / (R * R - x * x) + tangent2 + 1);
        EXPECT_NEAR(1 / curve.at(theta).speed_mm_rad, sine / r, 1e-15);
    }
}

// The misprinted equations in the form that holds, at places all round.
TEST(Xue, EquationsThatAreMisprinted) {
    const double R = 600, r = 150, step = 0.3;
    const SaddleCurve curve = pipes(R, r);
    for (const double theta : {0.1, 0.7, 1.4, 2.0, 3.5, 4.4, 5.9}) {
        const SaddlePoint s = curve.at(theta), next = curve.at(theta + step);
        const double x = s.p.x(), y = s.p.y(), z = s.p.z();
        EXPECT_NEAR(next.p.x(), x * std::cos(step) + y * std::sin(step), 1e-12 * r) << "(2)";
        EXPECT_NEAR(next.p.y(), y * std::cos(step) - x * std::sin(step), 1e-12 * r) << "(2)";
        EXPECT_NEAR(y * y - z * z, r * r - R * R, 1e-9) << "(5)";
        EXPECT_NEAR(s.n1.dot(s.n2), x * x / (R * r), 1e-14) << "(10)";
        const double root = std::sqrt(1 + std::pow(x / y, 2) + std::pow(x / z, 2));
        EXPECT_NEAR(std::abs(s.tangent.z()), std::copysign(1.0, x) * x / z / root, 1e-14) << "(20)";
    }
    // (10) has no absolute value: where the branch leans, the opening is below a right angle.
    EXPECT_LT(pipes(R, r, 60).at(0).n1.dot(pipes(R, r, 60).at(0).n2), 0);
}

TEST(Xue, SpeedErrorOfEulersStepsAndOfTheInvertedArc) {
    struct Case {
        double R, r, step, euler;
    };
    for (const Case& c :
         {Case{600, 150, 1, 5.6e-5}, Case{600, 150, 5, 3.2e-4}, Case{600, 540, 5, 2.1e-3}, Case{150, 149.9, 5, 0.10}}) {
        const SaddleCurve curve = pipes(c.R, c.r);
        const auto euler = step_angles(curve, StepLaw::variable_angle, c.step);
        EXPECT_NEAR(step_errors(curve, euler, c.step).chord / c.euler, 1, 0.1) << c.r << "/" << c.R;
        const auto inverted = step_angles(curve, StepLaw::arc_length, c.step);
        EXPECT_LT(step_errors(curve, inverted, c.step).arc * c.step, 1e-11) << c.r << "/" << c.R;
        EXPECT_EQ(inverted.back(), 2 * kPi);
        EXPECT_EQ(euler.back(), 2 * kPi);
    }
}

TEST(Xue, OpeningTorchAndCurvatureInClosedForm) {
    const double R = 600;
    for (const double r : {150.0, 540.0}) {
        const SaddleCurve curve = pipes(R, r);
        const double ratio = r / R;
        for (const double theta : {0.0, 0.3, kPi / 2, 2.0, 4.4}) {
            const SaddlePoint s = curve.at(theta);
            const double turn = std::asin(ratio * std::pow(std::sin(theta), 2));
            EXPECT_NEAR(s.opening, kPi / 2 + turn, 1e-14);
            EXPECT_NEAR(torch_angle(s, PoseLaw::bisector, 0), kPi / 4 + turn / 2, 1e-14);
            EXPECT_NEAR(torch_angle(s, PoseLaw::paper, kPi / 4), kPi / 4 + turn, 1e-14);
        }
        EXPECT_NEAR(curve.at(0).curvature_per_mm, std::hypot(1 / r, 1 / R), 1e-15);
        EXPECT_NEAR(curve.at(kPi / 2).curvature_per_mm, 1 / (r * std::sqrt(1 - ratio * ratio)), 1e-14);
    }
    const SaddlePoint side150 = pipes(R, 150).at(kPi / 2), side540 = pipes(R, 540).at(kPi / 2);
    EXPECT_EQ(fixed(degrees(side150.opening), 2), "104.48");
    EXPECT_EQ(fixed(degrees(torch_angle(side150, PoseLaw::bisector, 0)), 2), "52.24");
    EXPECT_EQ(fixed(degrees(torch_angle(side150, PoseLaw::paper, kPi / 4)), 2), "59.48");
    EXPECT_EQ(fixed(degrees(torch_angle(side540, PoseLaw::bisector, 0)), 1), "77.1");
    EXPECT_EQ(fixed(degrees(torch_angle(side540, PoseLaw::paper, kPi / 4)), 1), "109.2");
}

TEST(Xue, BisectorLeavesTheMeridianPlane) {
    EXPECT_NEAR(degrees(off_meridian(pipes(600, 150))), 4.79, 5e-3);
}

TEST(Saddle, LengthsAndOpeningsOfAnchors) {
    struct Case {
        double R, r, angle_deg, offset, length, least_deg, most_deg;
    };
    for (const Case& c :
         {Case{600, 150, 90, 0, 946.2677, 90, 104.48}, Case{600, 150, 60, 80, 1026.2496, 59.57, 123.75},
          Case{300, 270, 45, 0, 2244.3997, 45.00, 158.58}, Case{300, 100, 90, 195, 815.1349, 71.53, 169.52}}) {
        const SaddleCurve curve = pipes(c.R, c.r, c.angle_deg, c.offset);
        EXPECT_NEAR(curve.length(), c.length, 5e-5);
        double least = kPi, most = 0;
        for (int i = 0; i < 36000; ++i) {
            const double opening = curve.at(2 * kPi * i / 36000).opening;
            least = std::min(least, opening);
            most = std::max(most, opening);
        }
        EXPECT_NEAR(degrees(least), c.least_deg, 5.1e-3);
        EXPECT_NEAR(degrees(most), c.most_deg, 5.1e-3);
    }
}

class EverySaddle : public testing::TestWithParam<NamedSaddle> {};

// Roots by bisection of the header's distance along the generator, derivatives and length by differences of such roots:
// all in long double and without any formula of the curve.
TEST_P(EverySaddle, IsWhatASurfaceSurfaceSolveFinds) {
    const auto& [name, branch, zero, header] = GetParam();
    const SaddleCurve curve(branch, zero, header);
    const SaddleOracle oracle(branch, zero, header);
    for (int i = 0; i < 24; ++i) {
        const double theta = 0.05 + 2 * kPi * i / 24;
        const SaddlePoint s = curve.at(theta);
        const auto [p, tangent, curvature] = oracle.at(theta);
        EXPECT_LT((s.p - p).norm(), 1e-10) << name;
        EXPECT_LT((s.tangent - tangent).norm(), 1e-8) << name;
        EXPECT_NEAR(s.curvature_per_mm, curvature, 2e-7 * (1 + curvature)) << name;
        EXPECT_LT(std::abs(signed_distance(curve.branch(), s.p)), 1e-10);
        EXPECT_LT(std::abs(std::visit([&](const auto& h) { return oracle.gap(h, s.p); }, header)), 1e-10);
        EXPECT_LT((s.n1 - outward_normal(curve.branch(), s.p)).norm(), 1e-12);
        EXPECT_LT((s.n2 - std::visit([&](const auto& h) { return outward_normal(h, s.p); }, header)).norm(), 1e-12);
        EXPECT_GT(s.n1.cross(s.n2).dot(s.tangent), 0) << "flank 1 is the branch";
        EXPECT_NEAR(std::cos(kPi - s.opening), s.n1.dot(s.n2), 1e-14);
    }
    EXPECT_NEAR(curve.length(), oracle.length(), 2e-9 * curve.length()) << name;
}

TEST_P(EverySaddle, ArcLengthInvertsToAPicometre) {
    const auto& [name, branch, zero, header] = GetParam();
    const SaddleCurve curve(branch, zero, header);
    const double L = curve.length();
    for (int i = -700; i < 1700; ++i) {
        const double station = L * i / 997;
        EXPECT_NEAR(curve.station(curve.theta(station)), station, 5e-12) << name;
    }
    EXPECT_EQ(curve.theta(0), 0);
    EXPECT_NEAR(curve.station(2 * kPi), L, 1e-12);
    EXPECT_NEAR(curve.station(-1) + L, curve.station(2 * kPi - 1), 1e-11);
}

TEST_P(EverySaddle, MovesWithItsPart) {
    const auto& [name, branch, zero, header] = GetParam();
    const SaddleCurve curve(branch, zero, header);
    const Eigen::Isometry3d motion =
        Eigen::Translation3d(300, -700, 1200) * Eigen::AngleAxisd(1.1, Vector3d(1, 2, -0.5).normalized());
    const SaddleCurve moved_curve(moved(branch, motion), motion.linear() * zero, moved(header, motion));
    EXPECT_NEAR(moved_curve.length(), curve.length(), 1e-9);
    for (const double theta : {0.0, 1.0, 3.0, 5.5}) {
        EXPECT_LT((moved_curve.at(theta).p - motion * curve.at(theta).p).norm(), 1e-9) << name;
    }
}

TEST_P(EverySaddle, ModelIsTheCurveToATenthOfANanometre) {
    const auto& [name, branch, zero, header] = GetParam();
    const SaddleCurve curve(branch, zero, header);
    const SeamModel model = nominal_model(curve, PoseLaw::bisector, 0);
    EXPECT_LE(model.residual_max_mm, 1e-7);
    EXPECT_NEAR(model.length_mm, curve.length(), 1e-6);
    double off = 0, turned = 0;
    for (int i = 0; i < 5000; ++i) {
        const double station = curve.length() * (i + 0.37) / 5000;
        const SaddlePoint s = curve.at(curve.theta(station));
        off = std::max(off, (position(model.curve, station) - s.p).norm());
        const FlankSample flanks = flanks_at(model, station);
        turned = std::max({turned, (flanks.n1 - s.n1).norm(), (flanks.n2 - s.n2).norm()});
    }
    EXPECT_LT(off, 2e-7) << name;
    EXPECT_LT(degrees(turned), 1e-3) << name;
}

INSTANTIATE_TEST_SUITE_P(Saddle, EverySaddle, testing::ValuesIn(named_saddles()),
                         [](const auto& saddle) { return std::string(saddle.param.name); });

// Far from where it is used the branch's point is still on the same axis.
TEST(Saddle, DoesNotHangOnWhereTheAxisIsGiven) {
    const Vector3d axis = Vector3d(0, std::cos(1.0), std::sin(1.0));
    const Cylinder header{{0, 0, 0}, {0, 1, 0}, 600};
    const SaddleCurve near({{80, 0, 0}, axis, 150}, Vector3d::UnitY(), header);
    const SaddleCurve far({Vector3d(80, 0, 0) + 1e6 * axis, 3 * axis, 150}, Vector3d::UnitY(), header);
    EXPECT_LT((near.at(2.2).p - far.at(2.2).p).norm(), 1e-8);
}

std::string refusal(double R, double r, double angle_deg, double offset) {
    try {
        pipes(R, r, angle_deg, offset);
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

TEST(Saddle, RefusesWhatHasNoSeamAllRoundAndSaysWhy) {
    EXPECT_THAT(refusal(150, 160, 90, 0), HasSubstr("partial penetration: about branch angle 90.00 deg"));
    EXPECT_THAT(refusal(300, 100, 90, 201), HasSubstr("partial penetration"));
    EXPECT_THAT(refusal(300, 100, 90, 500), HasSubstr("beside the header, or runs along it, at every branch angle"));
    EXPECT_THAT(refusal(300, 100, 0, 0), HasSubstr("the angle between the branch and the header is 0 deg"));
    EXPECT_THAT(refusal(300, 100, 1e-7, 0), HasSubstr("only touches"));
    EXPECT_THAT(refusal(150, 150, 90, 0), HasSubstr("at branch angle 90.00 deg the branch's wall only touches"));
    EXPECT_THAT(refusal(150, 150, 35, 0), HasSubstr("only touches"));
    EXPECT_THAT(refusal(300, 100, 90, 200), HasSubstr("only touches"));
    EXPECT_THAT(refusal(300, 100, 90, -200), HasSubstr("at branch angle 270.00 deg"));
    EXPECT_THAT(refusal(300, 0, 90, 0), HasSubstr("the branch's radius, mm, is 0"));
    EXPECT_THAT(refusal(std::nan(""), 100, 90, 0), HasSubstr("the header's radius, mm, is nan"));
    EXPECT_THAT(refusal(300, 100, 90, std::nan("")), HasSubstr("is not finite"));
    EXPECT_EQ(refusal(150, 149.99999, 90, 0), "accepted");
}

TEST(Saddle, RefusesAnAxisThatPointsIntoThePlateAndAConeLeftBeyondItsApex) {
    const Cylinder down{{0, 0, 0}, {0, 0, -1}, 20};
    EXPECT_THROW(SaddleCurve(down, Vector3d::UnitX(), Plane{{0, 0, 0}, {0, 0, 1}}), InputError);
    const Cone cone{{0, 0, 100}, {0, 0, -1}, 0.3};
    EXPECT_THROW(SaddleCurve({{0, 0, 0}, {0, 0, -1}, 20}, Vector3d::UnitX(), cone), InputError);
    EXPECT_NEAR(SaddleCurve({{0, 0, 0}, {0, 0, 1}, 20}, Vector3d::UnitX(), cone).length(), 40 * kPi, 1e-10);
}

TEST(Nominal, FarFromTheOriginTheModelIsAsGoodAsItsCoordinates) {
    const SaddleCurve curve = pipes(1e9, 5);
    EXPECT_LT(nominal_model(curve, PoseLaw::bisector, 0).residual_max_mm, 2e-5);
    EXPECT_NEAR(curve.length(), 10 * kPi, 1e-6);
}

TEST(Nominal, StepsOfOddLengthsEndAtAFullTurn) {
    const SaddleCurve curve = pipes(600, 150);
    for (const StepLaw law : {StepLaw::equal_angle, StepLaw::variable_angle, StepLaw::arc_length}) {
        for (const double step : {0.7, 33.3, curve.length() / 7, curve.length(), 5000.0}) {
            const auto angles = step_angles(curve, law, step);
            EXPECT_EQ(angles.front(), 0);
            EXPECT_EQ(angles.back(), 2 * kPi);
            EXPECT_EQ(std::adjacent_find(angles.begin(), angles.end(), std::greater_equal<>()), angles.end());
            EXPECT_NEAR(static_cast<double>(angles.size()), std::ceil(curve.length() / step - 1e-9) + 1, 1);
        }
    }
}

// Planned by the laws, the torch stands at their angle to the branch's wall, square to travel.
TEST(Nominal, PlannedTorchStandsAsTheLawSays) {
    const SaddleCurve curve = pipes(600, 540);
    for (const PoseLaw law : {PoseLaw::bisector, PoseLaw::paper}) {
        const SeamModel model = nominal_model(curve, law, kPi / 6);
        const Plan planned = plan({&model, 1}, PlanOptions());
        int seen = 0;
        for (const Waypoint& w : planned.waypoints) {
            if (w.kind != WaypointKind::weld) {
                continue;
            }
            const SaddlePoint s = curve.at(curve.theta(w.station_mm));
            const Vector3d torch = w.q * -Vector3d::UnitZ();
            const double angle = std::atan2(torch.dot(s.n1), torch.dot(s.tangent.cross(s.n1)));
            EXPECT_NEAR(degrees(angle), degrees(torch_angle(s, law, kPi / 6)), 1e-3);
            EXPECT_NEAR(torch.dot(s.tangent), 0, 1e-6);
            EXPECT_LT((w.p - s.p).norm(), 1e-6);
            ++seen;
        }
        EXPECT_GT(seen, 100);
    }
}

}  // namespace saddle_test
}  // namespace seampath
