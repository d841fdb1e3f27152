#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/geometry/pose.hpp"
#include "stages/plan/plan.hpp"
#include "tests/fit/models.hpp"
#include "tests/geometry/boxes.hpp"

/// The torch round true corners.
namespace seampath {
namespace corner_plan_test {

using Eigen::Vector3d;

const SharpBox kBox = tilted_box();

SeamModel around_box() {
    return model_of(kBox.seam(1, 0.02, 1));
}

std::vector<Waypoint> weld_along(const SeamModel& model, const PlanOptions& options) {
    std::vector<Waypoint> weld;
    for (const Waypoint& w : plan(std::vector{model}, options).waypoints) {
        if (w.kind != WaypointKind::approach && w.kind != WaypointKind::retract) {
            weld.push_back(w);
        }
    }
    return weld;
}

double nearest_corner(const Vector3d& p) {
    double nearest = 1e9;
    for (const Vector3d& corner : kBox.corners()) {
        nearest = std::min(nearest, (corner - p).norm());
    }
    return nearest;
}

TEST(CornerPlan, GoesThroughEveryCornerAndTurnsLittleByLittle) {
    const PlanOptions options;
    const std::vector<Waypoint> weld = weld_along(around_box(), options);
    for (std::size_t k = 0; k < weld.size(); ++k) {
        EXPECT_LT(kBox.distance(weld[k].p), 0.04);
        if (k > 0) {
            EXPECT_LE(rotation_angle(weld[k - 1].q, weld[k].q), options.max_turn_deg * kDegree * (1 + 1e-9)) << k;
        }
    }
    for (const Vector3d& corner : kBox.corners()) {
        EXPECT_TRUE(
            std::any_of(weld.begin(), weld.end(), [&](const Waypoint& w) { return (w.p - corner).norm() < 0.03; }));
    }
}

TEST(CornerPlan, BeginsAwayFromCorners) {
    const std::vector<Waypoint> weld = weld_along(around_box(), {});
    EXPECT_NEAR(nearest_corner(weld.front().p), kBox.length / 2, 0.1);
    EXPECT_LT((weld.front().p - weld.back().p).norm(), 1e-9);
    PlanOptions there;
    there.start_station_mm = 20;
    EXPECT_NEAR(nearest_corner(weld_along(around_box(), there).front().p), 20, 0.05);
}

TEST(CornerPlan, HalfWayRoundTheTorchStandsBetweenBothSides) {
    const Vector3d up = kBox.pose.linear() * Vector3d::UnitZ();
    for (const Waypoint& w : weld_along(around_box(), {})) {
        const Vector3d wire = w.q * Vector3d::UnitZ();
        EXPECT_NEAR(wire.dot(-up), std::sqrt(0.5), 0.02) << "as steep on every side, and round corners too";
        if (nearest_corner(w.p) < 0.03) {
            const Vector3d in = (kBox.pose * Vector3d(kBox.length / 2, kBox.width / 2, 0) - w.p).normalized();
            EXPECT_GT((wire + up * std::sqrt(0.5)).normalized().dot(in), 0.9);
        }
    }
}

TEST(CornerPlan, TurnsWithinItsReachOnly) {
    for (const double reach : {4.0, 12.0}) {
        PlanOptions options;
        options.corner_reach_mm = reach;
        const std::vector<Waypoint> weld = weld_along(around_box(), options);
        for (std::size_t k = 1; k < weld.size(); ++k) {
            if (std::min(nearest_corner(weld[k - 1].p), nearest_corner(weld[k].p)) > reach + 0.05) {
                EXPECT_LT(rotation_angle(weld[k - 1].q, weld[k].q), 0.2 * kDegree) << reach;
            }
        }
    }
}

TEST(CornerPlan, IsTheSameWayBackwards) {
    PlanOptions back;
    back.backwards = true;
    const std::vector<Waypoint> there = weld_along(around_box(), {}), again = weld_along(around_box(), back);
    ASSERT_EQ(there.size(), again.size());
    for (std::size_t k = 0; k < there.size(); ++k) {
        const Waypoint& w = again[again.size() - 1 - k];
        EXPECT_LT((there[k].p - w.p).norm(), 0.01) << k;
        EXPECT_LT((there[k].q * Vector3d::UnitZ() - w.q * Vector3d::UnitZ()).norm(), 0.01) << k;
    }
}

TEST(CornerPlan, KeepsItsSpeedAndSlowsDownForALowTurnRate) {
    const PlanOptions options;
    for (const Waypoint& w : weld_along(around_box(), options)) {
        EXPECT_TRUE(w.kind == WaypointKind::weld_start || w.speed_mm_s == options.speed_mm_s);
    }
    PlanOptions slow;
    slow.turn_rate_deg_s = 20;
    const std::vector<Waypoint> weld = weld_along(around_box(), slow);
    double fastest = 0;
    for (std::size_t k = 1; k < weld.size(); ++k) {
        fastest = std::max(fastest, rotation_angle(weld[k - 1].q, weld[k].q) / (weld[k].time_s - weld[k - 1].time_s));
    }
    EXPECT_LT(fastest, 20.2 * kDegree);
    EXPECT_GT(fastest, 15 * kDegree);
}

TEST(CornerPlan, LeansWeavesAndOverlapsRoundCorners) {
    PlanOptions options;
    options.travel_angle_deg = 10;
    options.work_angle_deg = -5;
    options.overlap_mm = 15;
    options.weave = WeaveShape::sine;
    options.weave_amplitude_mm = 1.5;
    options.tilt_rate_deg_mm = 3;
    options.roll = RollLaw::least;
    const std::vector<Waypoint> weld = weld_along(around_box(), options);
    for (std::size_t k = 1; k < weld.size(); ++k) {
        EXPECT_LE(kBox.distance(weld[k].p), 1.6);
        EXPECT_LT(rotation_angle(weld[k - 1].q, weld[k].q), 3.01 * kDegree) << k;
    }
}

TEST(CornerPlan, SaysThatSeveralPassesNeedASmoothSeam) {
    PlanOptions options;
    options.groove = GrooveForm::fillet;
    options.groove_depth_mm = 8;
    EXPECT_THROW(plan(std::vector{around_box()}, options), InputError);
}

}  // namespace corner_plan_test
}  // namespace seampath
