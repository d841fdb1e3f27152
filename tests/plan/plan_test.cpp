#include "stages/plan/plan.hpp"

#include <cmath>
#include <ostream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/error.hpp"
#include "stages/geometry/pose.hpp"
#include "tests/plan/models.hpp"

namespace seampath {
namespace plan_test {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kDeg = test::kPi / 180;

std::vector<Waypoint> weld_of(const Plan& plan, int seam) {
    std::vector<Waypoint> weld;
    for (const Waypoint& w : plan.waypoints) {
        if (w.seam == seam &&
            (w.kind == WaypointKind::weld_start || w.kind == WaypointKind::weld || w.kind == WaypointKind::weld_end)) {
            weld.push_back(w);
        }
    }
    return weld;
}

struct Case {
    std::string name;
    test::Course course;
    bool closed;
    int controls;

    friend void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }
};

std::vector<Case> cases() {
    return {{"line", test::line(180), false, 4},
            {"circle", test::circle(40), true, 64},
            {"small_circle", test::circle(4), true, 64},
            {"helix", test::helix(35, 30), false, 120},
            {"rounded_box", test::rounded_box(80, 12), true, 160},
            {"s_curve", test::s_curve(200, 12), false, 120},
            {"flat_s_curve", test::s_curve(200, 0.05), false, 60}};
}

class PlanLaws : public testing::TestWithParam<Case> {
protected:
    SeamModel model(const test::Course& course) const {
        return test::model_of(course, GetParam().closed, GetParam().controls);
    }
    SeamModel model() const { return model(GetParam().course); }
};

INSTANTIATE_TEST_SUITE_P(Seams, PlanLaws, testing::ValuesIn(cases()),
                         [](const auto& tested) { return tested.param.name; });

// Brute force over 2000 stations under every move.
TEST_P(PlanLaws, ChordErrorAndTurnHoldEverywhere) {
    for (const double tolerance : {0.005, 0.02, 0.3}) {
        PlanOptions options;
        options.chord_tolerance_mm = tolerance;
        const SeamModel m = model();
        const Plan result = plan({&m, 1}, options);
        const std::vector<Waypoint> weld = weld_of(result, 0);
        const ArcLength arc(m.curve);
        double worst = 0, turn = 0;
        for (std::size_t k = 0; k + 1 < weld.size(); ++k) {
            turn = std::max(turn, rotation_angle(weld[k].q, weld[k + 1].q) / kDeg);
            const double from = arc.parameter(weld[k].station_mm);
            const double to = k + 2 == weld.size() ? last_parameter(m.curve) : arc.parameter(weld[k + 1].station_mm);
            for (int i = 0; i <= 2000; ++i) {
                const Eigen::Vector3d p = position(m.curve, from + (to - from) * i / 2000);
                worst = std::max(worst, distance_to_segment(p, weld[k].p, weld[k + 1].p));
            }
        }
        EXPECT_LE(worst, tolerance);
        EXPECT_LE(worst, result.max_chord_error_mm + 1e-12) << "the reported error is an upper bound";
        EXPECT_GE(worst, result.max_chord_error_mm - tolerance / 128) << "and a tight one";
        EXPECT_LE(turn, options.max_turn_deg + 1e-9);
        EXPECT_NEAR(turn, result.max_turn_deg, 1e-9);
    }
}

// Fewest moves over a fine grid of stations, each pair of them tried: breadth first, by what the moves are for. The
// grid may need a move more than free stations would, never one less.
TEST_P(PlanLaws, NoGridOfStationsDoesWithFewerMoves) {
    const PlanOptions options;
    const SeamModel m = model();
    const Plan result = plan({&m, 1}, options);
    const ArcLength arc(m.curve);
    const std::size_t grid = 1500;
    std::vector<Eigen::Vector3d> p;
    std::vector<Eigen::Quaterniond> q;
    for (std::size_t i = 0; i <= grid; ++i) {
        const double station = m.length_mm * static_cast<double>(i) / grid;
        const double u = i == grid ? last_parameter(m.curve) : arc.parameter(station);
        const FlankSample flanks = flanks_at(m, station);
        Eigen::Matrix3d tool;
        tool << tangent(m.curve, u), Eigen::Vector3d::Zero(), -(flanks.n1 + flanks.n2).normalized();
        tool.col(1) = tool.col(2).cross(tool.col(0));
        p.push_back(position(m.curve, u));
        q.emplace_back(tool);
    }
    const auto holds = [&](std::size_t a, std::size_t b) {
        for (std::size_t k = a + 1; k <= b; ++k) {
            if (distance_to_segment(p[k], p[a], p[b]) > options.chord_tolerance_mm * (1 - 1.0 / 128) ||
                rotation_angle(q[a], q[k]) > options.max_turn_deg * kDeg) {
                return false;
            }
        }
        return true;
    };
    std::size_t moves = 0;
    for (std::size_t reached = 0, before = 0; reached < grid; ++moves) {
        std::size_t next = reached;
        for (std::size_t a = before; a <= reached; ++a) {
            for (std::size_t b = next + 1; b <= grid && holds(a, b); ++b) {
                next = b;
            }
        }
        ASSERT_GT(next, reached);
        before = reached;
        reached = next;
    }
    EXPECT_LE(weld_of(result, 0).size() - 1, moves);
}

TEST_P(PlanLaws, TorchStandsOnTheBisectorAndTravelsAlongX) {
    const SeamModel m = model();
    const Plan result = plan({&m, 1}, {});
    const ArcLength arc(m.curve);
    for (const Waypoint& w : weld_of(result, 0)) {
        const FlankSample flanks = flanks_at(m, w.station_mm);
        const Eigen::Vector3d t = tangent(m.curve, arc.parameter(w.station_mm));
        const Eigen::Matrix3d tool = w.q.toRotationMatrix();
        EXPECT_LT((tool.col(0) - t).norm(), 1e-9);
        const Eigen::Vector3d bisector = flanks.n1 + flanks.n2;
        EXPECT_LT((tool.col(2) + (bisector - bisector.dot(t) * t).normalized()).norm(), 1e-9);
        EXPECT_LT((tool.col(2) + bisector.normalized()).norm(), 0.02) << "the flanks are square to travel here";
        EXPECT_NEAR(tool.determinant(), 1, 1e-12);
        EXPECT_GT((-tool.col(2)).dot(flanks.n1), 0.1) << "the torch body is outside the material";
        EXPECT_GT((-tool.col(2)).dot(flanks.n2), 0.1);
    }
}

TEST_P(PlanLaws, ToolSpeedIsConstant) {
    PlanOptions options;
    options.speed_mm_s = 8.5;
    const SeamModel m = model();
    const Plan result = plan({&m, 1}, options);
    const std::vector<Waypoint> weld = weld_of(result, 0);
    EXPECT_EQ(weld.front().station_mm, 0);
    EXPECT_DOUBLE_EQ(weld.back().station_mm, m.length_mm);
    double worst = 0;
    for (std::size_t k = 0; k + 1 < weld.size(); ++k) {
        const double ds = weld[k + 1].station_mm - weld[k].station_mm;
        EXPECT_NEAR(weld[k + 1].time_s - weld[k].time_s, ds / 8.5, 1e-12 * weld.back().time_s);
        EXPECT_EQ(weld[k + 1].speed_mm_s, 8.5);
        worst = std::max(worst, std::abs((weld[k + 1].p - weld[k].p).norm() / ds - 1));
    }
    EXPECT_NEAR(result.max_speed_error, worst, 1e-12);
    EXPECT_LT(result.max_speed_error, 0.002);
    EXPECT_NEAR(weld.back().time_s - weld.front().time_s, m.length_mm / 8.5, 1e-9);
}

TEST_P(PlanLaws, ApproachAndRetractStandBackAlongTheTorch) {
    PlanOptions options;
    options.approach_mm = 25;
    options.retract_mm = 40;
    const SeamModel m = model();
    const Plan result = plan({&m, 1}, options);
    const auto& w = result.waypoints;
    ASSERT_GE(w.size(), 4u);
    EXPECT_EQ(w.front().kind, WaypointKind::approach);
    EXPECT_EQ(w[1].kind, WaypointKind::weld_start);
    EXPECT_EQ(w[w.size() - 2].kind, WaypointKind::weld_end);
    EXPECT_EQ(w.back().kind, WaypointKind::retract);
    EXPECT_LT((w[1].p - 25 * (w[1].q * Eigen::Vector3d::UnitZ()) - w.front().p).norm(), 1e-12);
    EXPECT_LT((w[w.size() - 2].p - 40 * (w.back().q * Eigen::Vector3d::UnitZ()) - w.back().p).norm(), 1e-12);
    EXPECT_NEAR(result.duration_s, 25 / 100.0 + m.length_mm / 8 + 40 / 100.0, 1e-9);
    EXPECT_EQ(w.back().time_s, result.duration_s);
    EXPECT_EQ(w[1].speed_mm_s, 100);
    EXPECT_EQ(w.back().speed_mm_s, 100);
    EXPECT_EQ(w.back().station_mm, m.length_mm);
    for (std::size_t k = 0; k < w.size(); ++k) {
        EXPECT_EQ(w[k].index, static_cast<int>(k));
        EXPECT_DOUBLE_EQ(w[k].sigma_mm, 0.02);
    }
}

TEST_P(PlanLaws, QuaternionsNeverJump) {
    const SeamModel m = model();
    const Plan result = plan({&m, 1}, {});
    for (std::size_t k = 1; k < result.waypoints.size(); ++k) {
        EXPECT_GT(result.waypoints[k].q.dot(result.waypoints[k - 1].q), 0.99);
    }
}

// Only the direction of travel turns round: +Z stays, +X and +Y flip.
TEST_P(PlanLaws, ReversedSeamGivesReversedWaypoints) {
    const SeamModel there = model(), back = model(test::reversed(GetParam().course));
    const Plan a = plan({&there, 1}, {}), b = plan({&back, 1}, {});
    ASSERT_EQ(a.waypoints.size(), b.waypoints.size());
    const Eigen::Quaterniond turn_round(0, 0, 0, 1);
    for (std::size_t k = 0; k < a.waypoints.size(); ++k) {
        const Waypoint& from = a.waypoints[k];
        const Waypoint& to = b.waypoints[b.waypoints.size() - 1 - k];
        EXPECT_LT((from.p - to.p).norm(), 1e-4) << k;
        EXPECT_LT(rotation_angle(from.q * turn_round, to.q) / kDeg, 1e-3) << k;
        EXPECT_NEAR(from.station_mm, there.length_mm - to.station_mm, 1e-4);
    }
}

TEST_P(PlanLaws, MovedPartMovesThePlan) {
    Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
    motion.linear() = Eigen::Quaterniond(0.2, -0.7, 0.4, 0.55).normalized().toRotationMatrix();
    motion.translation() = Eigen::Vector3d(1200, -340, 77);
    const SeamModel here = model(), there = model(test::moved(GetParam().course, motion));
    const Plan a = plan({&here, 1}, {}), b = plan({&there, 1}, {});
    ASSERT_EQ(a.waypoints.size(), b.waypoints.size());
    for (std::size_t k = 0; k < a.waypoints.size(); ++k) {
        EXPECT_LT((motion * a.waypoints[k].p - b.waypoints[k].p).norm(), 1e-5) << k;
        EXPECT_LT(rotation_angle(Eigen::Quaterniond(motion.linear()) * a.waypoints[k].q, b.waypoints[k].q) / kDeg,
                  1e-4);
    }
}

TEST(Plan, StraightSeamNeedsTwoWaypoints) {
    const SeamModel m = test::model_of(test::line(180), false, 8);
    const Plan result = plan({&m, 1}, {});
    EXPECT_EQ(weld_of(result, 0).size(), 2u);
    EXPECT_LT(result.max_chord_error_mm, 1e-9);
    EXPECT_LT(result.max_speed_error, 1e-9);
    const double diagonal = 30 / std::sqrt(2.0);
    EXPECT_LT((result.waypoints.front().p - Eigen::Vector3d(0, diagonal, diagonal)).norm(), 1e-9);
}

// A step of angle a on radius r has sagitta r (1 - cos(a/2)); the tool frame turns by less than a, as its axis leans.
TEST(Plan, CircleTakesTheFewestEqualSteps) {
    for (const double radius : {40.0, 400.0}) {
        const SeamModel m = test::model_of(test::circle(radius), true, 64);
        PlanOptions options;
        options.max_turn_deg = 30;
        const std::vector<Waypoint> weld = weld_of(plan({&m, 1}, options), 0);
        const double step = 2 * std::acos(1 - options.chord_tolerance_mm * (1 - 1.0 / 256) / radius);
        EXPECT_EQ(weld.size() - 1, static_cast<std::size_t>(std::ceil(2 * test::kPi / step)));
        for (std::size_t k = 0; k + 1 < weld.size(); ++k) {
            EXPECT_NEAR(weld[k + 1].station_mm - weld[k].station_mm, m.length_mm / static_cast<double>(weld.size() - 1),
                        1e-9);
        }
    }
}

TEST(Plan, CircleTurnsByTheStepWhereTheTurnLimits) {
    const SeamModel m = test::model_of(test::circle(2), true, 400);
    PlanOptions options;
    options.chord_tolerance_mm = 0.1;
    options.max_turn_deg = 3.7;
    const Plan result = plan({&m, 1}, options);
    // The frame turns about Z as a whole, by the step: 360 / 3.7 = 97.3.
    EXPECT_EQ(weld_of(result, 0).size() - 1, 98u);
    EXPECT_NEAR(result.max_turn_deg, 360.0 / 98, 1e-4);
    EXPECT_NEAR(result.max_speed_error, 1 - std::sin(test::kPi / 98) / (test::kPi / 98), 1e-6);
}

TEST(Plan, ClosedSeamEndsWhereItBegan) {
    const SeamModel m = test::model_of(test::circle(40), true, 64);
    const std::vector<Waypoint> weld = weld_of(plan({&m, 1}, {}), 0);
    EXPECT_EQ(weld.front().p, weld.back().p);
    EXPECT_EQ(rotation_angle(weld.front().q, weld.back().q), 0);
    EXPECT_EQ(weld.front().kind, WaypointKind::weld_start);
    EXPECT_EQ(weld.back().kind, WaypointKind::weld_end);
}

// Along X with flanks +Y and +Z the torch body leans at 45 degrees; 15 degrees towards flank 1 is 30 from its wall.
TEST(Plan, WorkAngleLeansTowardsFlankOne) {
    const SeamModel m = test::model_of(test::line(50), false, 4);
    PlanOptions options;
    options.work_angle_deg = 15;
    const Plan result = plan({&m, 1}, options);
    const Eigen::Matrix3d tool = result.waypoints[1].q.toRotationMatrix();
    const Eigen::Vector3d body = -tool.col(2);
    EXPECT_NEAR(std::acos(body.y()) / kDeg, 60, 1e-9);
    EXPECT_NEAR(std::acos(body.z()) / kDeg, 30, 1e-9);
    EXPECT_LT((tool.col(0) - Eigen::Vector3d::UnitX()).norm(), 1e-12);
}

TEST(Plan, TravelAnglePointsAhead) {
    const SeamModel m = test::model_of(test::line(50), false, 4);
    PlanOptions options;
    options.travel_angle_deg = 10;
    const Plan result = plan({&m, 1}, options);
    const Eigen::Matrix3d tool = result.waypoints[1].q.toRotationMatrix();
    EXPECT_NEAR(tool.col(2).x(), std::sin(10 * kDeg), 1e-12);
    EXPECT_NEAR(tool.col(1).x(), 0, 1e-12);
    EXPECT_NEAR(tool.col(2).y(), tool.col(2).z(), 1e-12);
}

// Two fillets on the two sides of one web: the straight way between them leads through it.
TEST(Plan, GoesUpAndOverBetweenTheSidesOfAWeb) {
    const SeamModel left = test::model_of(test::line(100), false, 4);
    Eigen::Isometry3d other_side = Eigen::Isometry3d::Identity();
    other_side.linear() = Eigen::AngleAxisd(test::kPi, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    other_side.translation() = Eigen::Vector3d(100, -6, 0);
    const SeamModel right = test::model_of(test::moved(test::line(100), other_side), false, 4);
    const std::vector<SeamModel> both{left, right};
    const Plan result = plan(both, {});
    std::vector<WaypointKind> kinds;
    for (const Waypoint& w : result.waypoints) {
        kinds.push_back(w.kind);
    }
    using enum WaypointKind;
    EXPECT_THAT(kinds, testing::ElementsAre(approach, weld_start, weld_end, retract, air, approach, weld_start,
                                            weld_end, retract));
    const auto& w = result.waypoints;
    EXPECT_EQ(w[4].seam, 1);
    EXPECT_EQ(w[4].index, 0);
    EXPECT_EQ(w[5].index, 1);
    EXPECT_GT(w[4].p.z(), 30);
    EXPECT_NEAR(w[4].p.y(), -3, 1e-9) << "half way between the sides";
    EXPECT_NEAR(rotation_angle(w[3].q, w[4].q), rotation_angle(w[4].q, w[5].q), 1e-9);
    for (std::size_t k = 3; k < 5; ++k) {
        for (int i = 0; i <= 100; ++i) {
            const Eigen::Vector3d p = w[k].p + (w[k + 1].p - w[k].p) * i / 100;
            EXPECT_GT(distance_to_segment(p, w[1].p, w[2].p), 30 * (1 - 1e-3));
            EXPECT_GT(distance_to_segment(p, w[6].p, w[7].p), 30 * (1 - 1e-3));
        }
        EXPECT_NEAR(w[k + 1].time_s - w[k].time_s, (w[k + 1].p - w[k].p).norm() / 100, 1e-9);
    }
    for (std::size_t k = 1; k < w.size(); ++k) {
        EXPECT_GE(w[k].q.dot(w[k - 1].q), 0) << "signs hold over the whole plan";
        EXPECT_GE(w[k].time_s, w[k - 1].time_s);
    }
}

TEST(Plan, GoesStraightToASeamBeyond) {
    const SeamModel first = test::model_of(test::line(100), false, 4);
    Eigen::Isometry3d ahead = Eigen::Isometry3d::Identity();
    ahead.translation() = Eigen::Vector3d(150, 0, 0);
    const SeamModel second = test::model_of(test::moved(test::line(100), ahead), false, 4);
    const std::vector<SeamModel> both{first, second};
    const Plan result = plan(both, {});
    for (const Waypoint& w : result.waypoints) {
        EXPECT_NE(w.kind, WaypointKind::air);
    }
    EXPECT_EQ(result.waypoints.size(), 8u);
    EXPECT_NEAR(result.duration_s, 4 * 0.3 + 0.5 + 2 * 100 / 8.0, 1e-9);
}

TEST(Plan, NoSeamNoWaypoints) {
    const Plan result = plan({}, {});
    EXPECT_TRUE(result.waypoints.empty());
    EXPECT_EQ(result.duration_s, 0);
}

TEST(Plan, RefusesFlanksWithoutABisector) {
    SeamModel m = test::model_of(test::line(100), false, 8);
    for (FlankSample& flank : m.flanks) {
        if (flank.station_mm >= 60) {
            flank.n2 = -flank.n1;
        }
    }
    EXPECT_THAT(
        [&] {
            plan({&m, 1}, {});
        },
        ThrowsMessage<InputError>(AllOf(HasSubstr("plan: seam 0"), HasSubstr("at station"), HasSubstr("no bisector"))));
}

TEST(Plan, RefusesATorchDirectionThatJumps) {
    SeamModel m = test::model_of(test::line(100), false, 8);
    m.flanks = {{0, Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ(), 0, false},
                {50, Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ(), 0, false},
                {50, -Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ(), 0, false},
                {100, -Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ(), 0, false}};
    EXPECT_THAT(
        [&] {
            plan({&m, 1}, {});
        },
        ThrowsMessage<InputError>(AllOf(HasSubstr("jumps at station 50"), HasSubstr("max_turn_deg = 3"))));
}

TEST(Plan, RefusesASeamWithinAFewTolerances) {
    const SeamModel m = test::model_of(test::line(0.19), false, 4);
    EXPECT_THAT(
        [&] {
            plan({&m, 1}, {});
        },
        ThrowsMessage<InputError>(AllOf(HasSubstr("seam 0 is 0.19 mm long"), HasSubstr("longer than 0.2 mm"))));
}

TEST(Plan, OptionsHaveBoundsAndMeanings) {
    PlanOptions options;
    const Fields fields = describe(options);
    EXPECT_EQ(fields.size(), 69u);
    for (const Field& field : fields) {
        EXPECT_FALSE(field.meaning.empty()) << field.key;
        std::vector<double> values;
        if (const auto* number = std::get_if<double*>(&field.value)) {
            values.push_back(**number);
        } else if (const auto* list = std::get_if<std::vector<double>*>(&field.value)) {
            values = **list;
            EXPECT_EQ(static_cast<int>(values.size()), field.length) << field.key;
        }
        for (const double value : values) {
            EXPECT_GE(value, field.bounds.low) << field.key;
            EXPECT_LE(value, field.bounds.high) << field.key;
        }
    }
    EXPECT_TRUE(plan_problems(options).empty());
    options.flange_from_tool = {0, 0, 0, 0.5, 0, 0, 0};
    EXPECT_THAT(plan_problems(options), testing::ElementsAre(HasSubstr("flange_from_tool: the quaternion")));
}

}  // namespace plan_test
}  // namespace seampath
