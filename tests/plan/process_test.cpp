#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/error.hpp"
#include "stages/geometry/pose.hpp"
#include "stages/plan/plan.hpp"
#include "tests/plan/models.hpp"

namespace seampath {
namespace process_test {

using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;
using enum WaypointKind;

std::vector<Waypoint> welded(const Plan& plan) {
    std::vector<Waypoint> result;
    for (const Waypoint& w : plan.waypoints) {
        if (w.kind == weld_start || w.kind == weld || w.kind == weld_end) {
            result.push_back(w);
        }
    }
    return result;
}

std::vector<WaypointKind> kinds(const Plan& plan) {
    std::vector<WaypointKind> result;
    for (const Waypoint& w : plan.waypoints) {
        result.push_back(w.kind);
    }
    return result;
}

// ---- Where a weld begins and ends, and in which direction ----

TEST(Stretch, ClosedSeamBeginsWhereAskedAndGoesOverItsStart) {
    const SeamModel m = test::model_of(test::circle(40), true, 64);
    PlanOptions options;
    options.start_station_mm = 30;
    options.overlap_mm = 12;
    options.step_mm = 1;
    const std::vector<Waypoint> w = welded(plan({&m, 1}, options));
    EXPECT_NEAR(w.back().station_mm, m.length_mm + 12, 1e-9);
    const ArcLength arc(m.curve);
    for (const Waypoint& at : w) {
        const double angle = (30 + at.station_mm) / 40;
        EXPECT_LT((at.p - Vector3d(40 * std::cos(angle), 40 * std::sin(angle), 0)).norm(), 1e-5) << at.station_mm;
        const double u = nearest_parameter(m.curve, at.p);
        EXPECT_LT((position(m.curve, u) - at.p).norm(), 1e-10) << "on the seam's own curve";
    }
    options.start_station_mm = m.length_mm;
    EXPECT_THAT(
        [&] {
            plan({&m, 1}, options);
        },
        ThrowsMessage<InputError>(AllOf(HasSubstr("seam 0 is closed and 251.3"), HasSubstr("less than that"))));
}

// Of a seam and of the same from its other end: point for point.
TEST(Stretch, BackwardsIsTheReversedSeam) {
    for (const bool closed : {false, true}) {
        const test::Course course = closed ? test::rounded_box(80, 12) : test::helix(35, 30);
        const SeamModel m = test::model_of(course, closed, 160);
        PlanOptions options;
        const std::vector<Waypoint> there = plan({&m, 1}, options).waypoints;
        options.backwards = true;
        const std::vector<Waypoint> back = plan({&m, 1}, options).waypoints;
        ASSERT_EQ(there.size(), back.size());
        const Eigen::Quaterniond turn_round(0, 0, 0, 1);
        for (std::size_t k = 0; k < there.size(); ++k) {
            const Waypoint& other = back[back.size() - 1 - k];
            EXPECT_LT((there[k].p - other.p).norm(), 1e-3) << k;
            EXPECT_LT(rotation_angle(there[k].q * turn_round, other.q), 1e-4) << k;
        }
    }
}

TEST(Stretch, EndsMoveInAndOut) {
    const SeamModel m = test::model_of(test::helix(35, 30), false, 120);
    const ArcLength arc(m.curve);
    PlanOptions options;
    options.step_mm = 0.5;
    options.extend_start_mm = -7;
    options.extend_end_mm = 9;
    const std::vector<Waypoint> w = welded(plan({&m, 1}, options));
    EXPECT_NEAR(w.back().station_mm, m.length_mm + 2, 1e-9);
    EXPECT_LT((w.front().p - position(m.curve, arc.parameter(7))).norm(), 1e-9);
    const double last = last_parameter(m.curve);
    const Vector3d end = position(m.curve, last) + 9 * tangent(m.curve, last);
    EXPECT_LT((w.back().p - end).norm(), 1e-9);
    for (std::size_t k = 1; k < w.size(); ++k) {
        EXPECT_LT(rotation_angle(w[k - 1].q, w[k].q), 0.05);
    }
    options.extend_start_mm = -200;
    options.extend_end_mm = -200;
    EXPECT_THAT(
        [&] {
            plan({&m, 1}, options);
        },
        ThrowsMessage<InputError>(AllOf(HasSubstr("nothing is left of it"), HasSubstr("trim it by less"))));
}

// ---- Pieces ----

TEST(Pattern, StitchesHaveTheirLengthAndBothEnds) {
    const SeamModel m = test::model_of(test::line(400), false, 8);
    PlanOptions options;
    options.pattern = WeldPattern::stitch;
    options.stitch_length_mm = 30;
    options.stitch_gap_mm = 50;
    const Plan result = plan({&m, 1}, options);
    const std::vector<Waypoint> w = welded(result);
    // (400 + 50) / 80 = 5.6: six stitches, five gaps of 44 mm.
    ASSERT_EQ(w.size(), 12u);
    for (std::size_t k = 0; k < 6; ++k) {
        const double from = 74.0 * static_cast<double>(k);
        EXPECT_EQ(w[2 * k].kind, weld_start);
        EXPECT_EQ(w[2 * k + 1].kind, weld_end);
        EXPECT_NEAR(w[2 * k].p.x(), from, 1e-9);
        EXPECT_NEAR(w[2 * k + 1].p.x(), from + 30, 1e-9);
        EXPECT_NEAR(w[2 * k].station_mm, from, 1e-9) << "stations are the seam's";
        EXPECT_NEAR(w[2 * k + 1].time_s - w[2 * k].time_s, 30 / 8.0, 1e-9);
    }
    for (std::size_t k = 1; k < result.waypoints.size(); ++k) {
        EXPECT_EQ(result.waypoints[k].index, static_cast<int>(k)) << "one seam";
        EXPECT_GT(result.waypoints[k].time_s, result.waypoints[k - 1].time_s);
    }
}

TEST(Pattern, TacksGoRoundAClosedSeam) {
    const SeamModel m = test::model_of(test::circle(40), true, 64);
    PlanOptions options;
    options.pattern = WeldPattern::tack;
    options.tacks = 4;
    options.tack_length_mm = 8;
    const std::vector<Waypoint> w = welded(plan({&m, 1}, options));
    int tacks = 0;
    for (const Waypoint& at : w) {
        const double angle = std::atan2(at.p.y(), at.p.x());
        if (at.kind == weld_start) {
            EXPECT_NEAR(std::remainder(angle - tacks * test::kPi / 2, 2 * test::kPi), 0, 1e-6);
            ++tacks;
        } else if (at.kind == weld_end) {
            EXPECT_NEAR(std::remainder(angle - (tacks - 1) * test::kPi / 2, 2 * test::kPi), 8.0 / 40, 1e-6);
        }
    }
    EXPECT_EQ(tacks, 4);
    options.tack_length_mm = 70;
    EXPECT_THAT(
        [&] {
            plan({&m, 1}, options);
        },
        ThrowsMessage<InputError>(AllOf(HasSubstr("4 tacks of plan.tack_length_mm = 70"), HasSubstr("shorter"))));
}

// ---- Before the arc burns and after ----

TEST(Leads, LieAlongTravelOutsideTheWeld) {
    const SeamModel m = test::model_of(test::line(100), false, 4);
    PlanOptions options;
    options.lead_in_mm = 12;
    options.lead_out_mm = 5;
    options.travel_angle_deg = 10;
    const Plan result = plan({&m, 1}, options);
    EXPECT_THAT(kinds(result), testing::ElementsAre(approach, approach, weld_start, weld_end, retract, retract));
    const auto& w = result.waypoints;
    EXPECT_LT((w[1].p - Vector3d(-12, 0, 0)).norm(), 1e-9);
    EXPECT_LT((w[4].p - Vector3d(105, 0, 0)).norm(), 1e-9);
    EXPECT_LT((w[0].p - w[1].p + 30 * (w[1].q * Vector3d::UnitZ())).norm(), 1e-9);
    EXPECT_NEAR(w[2].time_s - w[1].time_s, 12 / 8.0, 1e-9);
    EXPECT_NEAR(w[4].time_s - w[3].time_s, 5 / 8.0, 1e-9);
    EXPECT_EQ(w[2].speed_mm_s, 8);
    EXPECT_EQ(w[4].speed_mm_s, 8);
    options.lead_in_mm = 98;
    EXPECT_THAT(
        [&] {
            plan({&m, 1}, options);
        },
        ThrowsMessage<InputError>(AllOf(HasSubstr("welded over 100 mm"), HasSubstr("lead-in and lead-out of 103"))));
}

// v = 50, a = 100, j = 400: 0.75 s over 18.75 mm, and the weld itself at one speed.
TEST(Leads, AreAsLongAsTheRunInTakes) {
    const SeamModel m = test::model_of(test::line(100), false, 4);
    PlanOptions options;
    options.run_in = RunIn::before;
    options.speed_mm_s = 50;
    options.acceleration_mm_s2 = 100;
    options.jerk_mm_s3 = 400;
    options.lead_out_mm = 30;
    const auto w = plan({&m, 1}, options).waypoints;
    ASSERT_EQ(w.size(), 6u);
    EXPECT_NEAR(w[1].p.x(), -18.75, 1e-9);
    EXPECT_NEAR(w[2].time_s - w[1].time_s, 0.75, 1e-9);
    EXPECT_NEAR(w[3].time_s - w[2].time_s, 2, 1e-9);
    EXPECT_NEAR(w[4].time_s - w[3].time_s, 0.75 + (30 - 18.75) / 50, 1e-9);
    EXPECT_EQ(w[3].speed_mm_s, 50);
}

TEST(Crater, GoesBackBeforeTheArcEnds) {
    const SeamModel m = test::model_of(test::s_curve(200, 12), false, 120);
    const ArcLength arc(m.curve);
    PlanOptions options;
    options.crater_back_mm = 6;
    const std::vector<Waypoint> w = welded(plan({&m, 1}, options));
    EXPECT_EQ(w.back().kind, weld_end);
    EXPECT_LT((w.back().p - position(m.curve, arc.parameter(m.length_mm - 6))).norm(), 1e-9);
    double furthest = 0;
    for (const Waypoint& at : w) {
        furthest = std::max(furthest, at.station_mm);
    }
    EXPECT_NEAR(furthest, m.length_mm, 1e-9) << "the whole seam is welded";
    EXPECT_NEAR(w.back().time_s - w.front().time_s, (m.length_mm + 6) / 8, 1e-9);
    options.crater_back_mm = 80;
    const SeamModel tight = test::model_of(test::line(50), false, 4);
    EXPECT_THAT(
        [&] {
            plan({&tight, 1}, options);
        },
        ThrowsMessage<InputError>(HasSubstr("no more than its way back of 80 mm")));
}

// ---- Weaving ----

/// Across towards flank 1 and up, of the joint of test::line(): flanks +Y and +Z.
const Vector3d kAcross = Vector3d(0, -1, 1).normalized(), kUp = Vector3d(0, 1, 1).normalized();

std::vector<Waypoint> woven(WeaveShape shape, PlanOptions options = {}, double length = 40) {
    options.weave = shape;
    options.weave_amplitude_mm = 3;
    options.weave_pitch_mm = 4;
    const SeamModel m = test::model_of(test::line(length), false, 4);
    return welded(plan({&m, 1}, options));
}

// Every place of the moves against the closed form of the shape, and every waypoint on it.
TEST(Weave, SmoothShapesAreWithinTheTolerance) {
    for (const WeaveShape shape : {WeaveShape::sine, WeaveShape::circle, WeaveShape::figure_eight}) {
        const std::vector<Waypoint> w = woven(shape);
        const auto at = [&](double station) -> Vector3d {
            const double phi = 2 * test::kPi * station / 4;
            const double along = shape == WeaveShape::circle         ? 3 * (std::cos(phi) - 1)
                                 : shape == WeaveShape::figure_eight ? 1.5 * std::sin(2 * phi)
                                                                     : 0;
            return Vector3d(station + along, 0, 0) + 3 * std::sin(phi) * kAcross;
        };
        double worst = 0;
        for (std::size_t k = 1; k < w.size(); ++k) {
            EXPECT_LT((w[k].p - at(w[k].station_mm)).norm(), 1e-9);
            for (int i = 1; i < 20; ++i) {
                const double station = w[k - 1].station_mm + (w[k].station_mm - w[k - 1].station_mm) * i / 20;
                worst = std::max(worst, distance_to_segment(at(station), w[k - 1].p, w[k].p));
            }
            EXPECT_NEAR(w[k].time_s - w[k - 1].time_s, (w[k].station_mm - w[k - 1].station_mm) / 8, 1e-9);
            EXPECT_NEAR(w[k].speed_mm_s * (w[k].time_s - w[k - 1].time_s), (w[k].p - w[k - 1].p).norm(), 1e-9);
        }
        EXPECT_LE(worst, 0.02);
        EXPECT_GT(worst, 0.002) << "and not with far more waypoints than that takes";
        EXPECT_LT(w.front().p.norm(), 1e-9);
        EXPECT_LT((w.back().p - Vector3d(40, 0, 0)).norm(), 1e-9) << "ends on the seam";
    }
}

TEST(Weave, StraightShapesHaveTheirCornersOnly) {
    const std::vector<Waypoint> zigzag = woven(WeaveShape::zigzag);
    ASSERT_EQ(zigzag.size(), 31u) << "two sides and the middle in each of ten swings, and the end";
    const std::vector<double> across{0, 3, -3};
    for (std::size_t k = 0; k < 30; ++k) {
        EXPECT_NEAR(zigzag[k].p.dot(kAcross), across[k % 3], 1e-9);
        EXPECT_NEAR(zigzag[k].p.dot(kUp), 0, 1e-9);
    }
    // A joint of 90 deg: along its flanks, up as far as across.
    const std::vector<Waypoint> triangle = woven(WeaveShape::triangle);
    ASSERT_EQ(triangle.size(), 31u);
    for (std::size_t k = 0; k < 30; ++k) {
        EXPECT_NEAR(triangle[k].p.dot(kAcross), across[k % 3], 1e-9);
        EXPECT_NEAR(triangle[k].p.dot(kUp), k % 3 == 0 ? 0 : 3, 1e-9);
    }
}

TEST(Weave, WaitsAtTheSides) {
    PlanOptions options;
    options.weave_dwell_s = 0.1;  // 0.8 mm of 4
    const std::vector<Waypoint> w = woven(WeaveShape::zigzag, options);
    ASSERT_EQ(w.size(), 51u);
    for (std::size_t k = 0; k < 50; k += 5) {
        for (const std::size_t side : {k + 1, k + 3}) {
            EXPECT_NEAR(w[side + 1].time_s - w[side].time_s, 0.1, 1e-9);
            EXPECT_NEAR((w[side + 1].p - w[side].p).norm(), 0.8, 1e-9) << "along only";
            EXPECT_NEAR(std::abs(w[side].p.dot(kAcross)), 3, 1e-9);
        }
    }
    options.weave_dwell_s = 0.3;
    options.weave = WeaveShape::zigzag;
    EXPECT_THAT(plan_problems(options), testing::ElementsAre(HasSubstr("weave_dwell_s: twice 0.3 s leave no time")));
}

TEST(Weave, FrequencyIsSwingsASecond) {
    PlanOptions options;
    options.weave_frequency_hz = 2.5;  // at 8 mm/s: a swing in 3.2 mm
    const std::vector<Waypoint> w = woven(WeaveShape::zigzag, options, 64);
    EXPECT_EQ(w.size(), 3u * 20 + 1);
    EXPECT_NEAR(w.back().time_s - w.front().time_s, 20 / 2.5, 1e-9);
    options.weave_frequency_hz = 0.01;
    EXPECT_THAT([&] { woven(WeaveShape::zigzag, options); },
                ThrowsMessage<InputError>(AllOf(HasSubstr("less than half of a swing of 800 mm"))));
}

TEST(Weave, KeepsToABentSeamsFrame) {
    PlanOptions options;
    options.weave = WeaveShape::sine;
    options.weave_pitch_mm = 5;
    options.weave_amplitude_mm = 2;
    const SeamModel m = test::model_of(test::circle(40), true, 128);
    double most = 0;
    for (const Waypoint& w : welded(plan({&m, 1}, options))) {
        const double angle = w.station_mm / 40;
        const Vector3d out(std::cos(angle), std::sin(angle), 0), off = w.p - 40 * out;
        const Vector3d along(-out.y(), out.x(), 0);
        EXPECT_NEAR(off.dot(along), 0, 1e-5);
        EXPECT_NEAR(off.dot(out + Vector3d::UnitZ()), 0, 1e-5) << "square to the bisector";
        most = std::max(most, off.norm());
    }
    EXPECT_NEAR(most, 2, 1e-3);
}

// Speed zero and the like are refused before there is a plan.
TEST(Process, BoundsKeepSenselessValuesOut) {
    PlanOptions options;
    for (const Field& field : describe(options)) {
        if (field.key == "speed_mm_s" || field.key == "acceleration_mm_s2" || field.key == "weave_pitch_mm" ||
            field.key == "stitch_length_mm") {
            EXPECT_GT(field.bounds.low, 0) << field.key;
        }
    }
}

}  // namespace process_test
}  // namespace seampath
