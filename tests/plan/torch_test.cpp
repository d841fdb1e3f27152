#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/error.hpp"
#include "stages/geometry/pose.hpp"
#include "stages/geometry/saddle.hpp"
#include "stages/plan/plan.hpp"
#include "stages/plan/tilt.hpp"
#include "tests/plan/models.hpp"

namespace seampath {
namespace torch_test {

using Eigen::Vector3d;
using testing::HasSubstr;

constexpr double kDeg = test::kPi / 180;

std::vector<Waypoint> weld_of(const SeamModel& model, const PlanOptions& options) {
    std::vector<Waypoint> w = plan({&model, 1}, options).waypoints;
    w.erase(w.begin());
    w.pop_back();
    return w;
}

/// Pipe of radius 150 on a pipe of radius 600, axes Z and Y.
SaddleCurve saddle() {
    return {{Vector3d::Zero(), Vector3d::UnitZ(), 150},
            Vector3d::UnitY(),
            Cylinder{Vector3d::Zero(), Vector3d::UnitY(), 600}};
}

// Table 1 of the paper, by its closed form (papers, errata): delta = pi/4 + asin(r sin^2 theta / R), from the branch.
TEST(TorchLaw, OfXueKeepsTheAngleToTheHeader) {
    const SaddleCurve curve = saddle();
    const SeamModel m = test::model_of(
        [&](double t) {
            const SaddlePoint s = curve.at(2 * test::kPi * t);
            return test::Place{s.p, s.n1, s.n2};
        },
        true, 200);
    PlanOptions options;
    options.torch_law = TorchLaw::flank2;
    double widest = 0;
    for (const Waypoint& w : weld_of(m, options)) {
        const double sine = w.p.x() / 150, delta = test::kPi / 4 + std::asin(150 * sine * sine / 600);
        const Vector3d body = w.q * -Vector3d::UnitZ();
        const Vector3d branch(w.p.x() / 150, w.p.y() / 150, 0), header(w.p.x() / 600, 0, w.p.z() / 600);
        // Angles in the section square to travel, as the flanks are.
        EXPECT_NEAR(std::asin(body.dot(branch)), delta, 2e-3);
        EXPECT_NEAR(std::asin(body.dot(header)), test::kPi / 4, 1e-4);
        widest = std::max(widest, std::asin(body.dot(branch)));
    }
    EXPECT_NEAR(widest / kDeg, 59.48, 0.02) << "where the bisector stands at 52.24";
}

TEST(TorchLaw, KeepsTheAngleThatWasAsked) {
    const SeamModel m = test::model_of(test::line(50), false, 4);
    PlanOptions options;
    options.torch_law = TorchLaw::flank1;
    options.flank_angle_deg = 35;
    const Vector3d body = weld_of(m, options).front().q * -Vector3d::UnitZ();
    EXPECT_NEAR(std::asin(body.y()) / kDeg, 35, 1e-9) << "flank 1 is the wall y = 0";
    options.torch_law = TorchLaw::flank2;
    EXPECT_NEAR(std::asin((weld_of(m, options).front().q * -Vector3d::UnitZ()).z()) / kDeg, 35, 1e-9);
}

TEST(AngleTable, IsStraightBetweenItsStations) {
    const SeamModel m = test::model_of(test::line(100), false, 8);
    PlanOptions options;
    options.angle_table = {20, 0, -5, 60, 10, 15};
    options.step_mm = 1;
    const Plan result = plan({&m, 1}, options);
    for (const TravelSample& s : result.travel) {
        const double share = std::clamp((s.station_mm - 20) / 40, 0.0, 1.0);
        EXPECT_NEAR(s.work_rad / kDeg, 10 * share, 1e-9) << s.station_mm;
        EXPECT_NEAR(s.travel_rad / kDeg, -5 + 20 * share, 1e-9) << s.station_mm;
    }
    options.angle_table = {20, 0, -5, 10, 10, 15, 7};
    EXPECT_THAT(plan_problems(options), testing::ElementsAre(HasSubstr("angle_table: 7 numbers; three for each place"),
                                                             HasSubstr("station 10 does not lie behind")));
}

/// A straight joint whose flanks turn about it by 30 deg between stations 49 and 51, and a step of noise.
SeamModel twisted() {
    SeamModel m = test::model_of(test::line(100), false, 8);
    m.flanks.clear();
    for (double s = 0; s <= 100; s += 0.5) {
        const double turn = 30 * kDeg * std::clamp((s - 49) / 2, 0.0, 1.0);
        const Eigen::AngleAxisd about(turn, Vector3d::UnitX());
        m.flanks.push_back({s, about * Vector3d::UnitY(), about * Vector3d::UnitZ(), 0.02, false});
    }
    return m;
}

double lean_of(const Waypoint& w) {
    const Vector3d body = w.q * -Vector3d::UnitZ();
    return std::atan2(body.z(), body.y()) / kDeg;
}

// 15 deg in a millimetre; at 1 deg/mm it takes what the step is high on each side of it, alike from either end.
TEST(TiltRate, IsKeptAndSpreadEvenly) {
    const SeamModel m = twisted();
    PlanOptions options;
    options.step_mm = 0.25;
    double steepest = 0;
    std::vector<Waypoint> w = weld_of(m, options);
    for (std::size_t k = 1; k < w.size(); ++k) {
        steepest = std::max(steepest, std::abs(lean_of(w[k]) - lean_of(w[k - 1])) / 0.25);
    }
    EXPECT_NEAR(steepest, 15, 0.5);
    options.tilt_rate_deg_mm = 1;
    w = weld_of(m, options);
    for (std::size_t k = 0; k < w.size(); ++k) {
        // Half of it by the one envelope, which rises from 49 to 79, half by the other, from 21 to 51.
        const double late = std::clamp(w[k].station_mm - 49, 0.0, 30.0);
        const double early = std::clamp(w[k].station_mm - 21, 0.0, 30.0);
        EXPECT_NEAR(lean_of(w[k]), 45 + 0.5 * (late + early), 1e-6) << w[k].station_mm;
        if (k > 0) {
            EXPECT_LE(std::abs(lean_of(w[k]) - lean_of(w[k - 1])), 0.25 * 1.001 + 1e-9);
        }
        EXPECT_LT((w[k].q * Vector3d::UnitX() - Vector3d::UnitX()).norm(), 1e-9) << "only about travel";
    }
    EXPECT_NEAR(lean_of(w.front()), 45, 1e-9);
    EXPECT_NEAR(lean_of(w.back()), 75, 1e-9);
}

// A torch that leans no faster than the limit stays as it is; a ring's does not turn against the ring at all.
TEST(TiltRate, LeavesASteadyTorchAlone) {
    const SeamModel m = test::model_of(test::circle(40), true, 64);
    PlanOptions options;
    const std::vector<Waypoint> as_it_is = weld_of(m, options);
    options.tilt_rate_deg_mm = 0.05;
    const std::vector<Waypoint> smoothed = weld_of(m, options);
    ASSERT_EQ(as_it_is.size(), smoothed.size());
    for (std::size_t k = 0; k < as_it_is.size(); ++k) {
        EXPECT_LT(rotation_angle(as_it_is[k].q, smoothed[k].q) / kDeg, 0.01) << k;
    }
}

// A helix's frames turn against those that turn least by its torsion (Frenet): 2 pi h n / sqrt(...) in n turns.
TEST(LeastTurning, OfAHelixIsItsTorsion) {
    const double radius = 35, rise = 30 / (2 * test::kPi), length = std::hypot(radius, rise);
    std::vector<planning::Place> places;
    const int steps = 400;
    for (int k = 0; k <= steps; ++k) {
        const double a = 2 * test::kPi * k / steps;
        places.push_back({{radius * std::cos(a), radius * std::sin(a), rise * a},
                          Vector3d(-radius * std::sin(a), radius * std::cos(a), rise) / length,
                          Vector3d::UnitZ()});
    }
    const std::vector<Vector3d> r = planning::least_turning(places, -Vector3d::UnitX());
    const Vector3d normal(-1, 0, 0), binormal = places.back().x.cross(normal);
    const double turned = std::atan2(r.back().dot(binormal), r.back().dot(normal));
    EXPECT_NEAR(turned, -2 * test::kPi * rise / length, 1e-7);
    for (std::size_t k = 0; k < r.size(); ++k) {
        EXPECT_NEAR(r[k].dot(places[k].x), 0, 1e-12);
    }
}

// Round a ring the wire goes once round a cone: turned least it comes back turned by the cone's solid angle.
TEST(Roll, TurnsLeast) {
    const SeamModel m = test::model_of(test::circle(40), true, 64);
    PlanOptions options;
    options.roll = RollLaw::least;
    options.step_mm = 0.2;
    const std::vector<Waypoint> w = weld_of(m, options);
    options.roll = RollLaw::travel;
    const std::vector<Waypoint> along = weld_of(m, options);
    ASSERT_EQ(w.size(), along.size());
    double turned = 0, turned_along = 0, spun = 0;
    for (std::size_t k = 1; k < w.size(); ++k) {
        EXPECT_LT((w[k].q * Vector3d::UnitZ() - along[k].q * Vector3d::UnitZ()).norm(), 1e-9) << "the same wire";
        turned += rotation_angle(w[k - 1].q, w[k].q);
        turned_along += rotation_angle(along[k - 1].q, along[k].q);
        spun += std::abs(rotation_vector(w[k - 1].q.conjugate() * w[k].q).z());
    }
    EXPECT_NEAR(turned, 2 * test::kPi * std::sin(test::kPi / 4), 1e-3) << "the wire's own way on the sphere";
    EXPECT_NEAR(turned_along, 2 * test::kPi, 1e-3);
    EXPECT_LT(spun, 1e-3);
    const double end = rotation_angle(w.front().q, w.back().q);
    EXPECT_NEAR(end, 2 * test::kPi * (1 - std::cos(test::kPi / 4)), 1e-3);
}

TEST(Roll, IsFixedWhereAsked) {
    const SeamModel m = test::model_of(test::line(50), false, 4);
    PlanOptions options;
    options.roll_deg = 30;
    const Waypoint w = weld_of(m, options).front();
    const Vector3d x = w.q * Vector3d::UnitX();
    EXPECT_NEAR(std::acos(x.x()) / kDeg, 30, 1e-9);
    EXPECT_NEAR(x.dot(w.q * Vector3d::UnitZ()), 0, 1e-12);
}

}  // namespace torch_test
}  // namespace seampath
