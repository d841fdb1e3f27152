#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/geometry/pose.hpp"
#include "stages/geometry/urdf.hpp"
#include "stages/plan/arm_air.hpp"
#include "stages/plan/plan.hpp"
#include "tests/geometry/arms.hpp"
#include "tests/plan/models.hpp"

namespace seampath {
namespace arm_test {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using test::kDegree;
using test::kPi;
using testing::AllOf;
using testing::HasSubstr;

/// A torch of 300 mm with a neck of 35 deg.
ArmCell cell_with(const std::string& arm, const Isometry3d& base_from_scan) {
    ArmCell cell{load_arm(arm).arm, base_from_scan, Isometry3d::Identity()};
    cell.flange_from_tool = Eigen::Translation3d(40, 0, 300) * Eigen::AngleAxisd(35 * kDegree, Vector3d::UnitY());
    return cell;
}

Isometry3d at(double x, double y, double z, double turn_deg = 0) {
    return Isometry3d(Eigen::Translation3d(x, y, z) * Eigen::AngleAxisd(turn_deg * kDegree, Vector3d::UnitZ()));
}

/// All that a travel promises.
void expect_laws(const Plan& plan, const ArmCell& cell, const PlanOptions& options) {
    const ArmTravel& arm = *plan.arm;
    double margin = 10, duration = 0;
    std::size_t waypoints = 0;
    for (std::size_t k = 0; k < arm.samples.size(); ++k) {
        const ArmSample& s = arm.samples[k];
        const JointAngles q(s.q.data());
        margin = std::min(margin, limit_margin(cell.arm, q));
        duration = s.time_s;
        ASSERT_LE(std::abs(s.roll), options.arm_roll_deg * kDegree + 1e-9);
        const Isometry3d tool = cell.base_from_scan.inverse() * forward(cell.arm, q) * cell.flange_from_tool;
        if (s.waypoint >= 0) {
            const Waypoint& w = plan.waypoints.at(static_cast<std::size_t>(s.waypoint));
            ++waypoints;
            ASSERT_LT((tool.translation() - w.p).norm(), 1e-6);
            ASSERT_LT(rotation_angle(Eigen::Quaterniond(tool.linear()), w.q), 1e-9);
            ASSERT_EQ(s.kind, w.kind);
            ASSERT_EQ(s.time_s, w.time_s);
        }
        if (k == 0) {
            continue;
        }
        const ArmSample& before = arm.samples[k - 1];
        ASSERT_GE(s.time_s, before.time_s);
        for (std::size_t i = 0; i < 6; ++i) {
            const double step = std::abs(s.q[i] - before.q[i]);
            ASSERT_LE(step, arm.max_speed[i] * (s.time_s - before.time_s) * (1 + 1e-9) + 1e-9)
                << "axis " << i + 1 << " at sample " << k;
            ASSERT_TRUE(s.kind == WaypointKind::air || step < 21 * kDegree);
        }
    }
    EXPECT_GE(margin, 0);
    EXPECT_NEAR(margin, arm.least_margin, 1e-12);
    EXPECT_NEAR(duration, arm.duration_s, 1e-12);
    EXPECT_EQ(plan.duration_s, arm.duration_s);
    EXPECT_EQ(waypoints, plan.waypoints.size()) << "every waypoint has its angles";
}

// Between two samples the tool stays on its way: looked at where the samples' angles are half way.
double worst_between(const Plan& plan, const ArmCell& cell) {
    double worst = 0;
    const auto& samples = plan.arm->samples;
    for (std::size_t k = 1; k < samples.size(); ++k) {
        if (samples[k].kind != WaypointKind::weld && samples[k].kind != WaypointKind::weld_end) {
            continue;
        }
        const JointAngles a(samples[k - 1].q.data()), b(samples[k].q.data());
        const Vector3d middle = (forward(cell.arm, 0.5 * (a + b)) * cell.flange_from_tool).translation();
        const Vector3d from = (forward(cell.arm, a) * cell.flange_from_tool).translation();
        const Vector3d to = (forward(cell.arm, b) * cell.flange_from_tool).translation();
        worst = std::max(worst, distance_to_segment(middle, from, to));
    }
    return worst;
}

TEST(ArmTravel, EveryArmWeldsAStraightSeamInFrontOfIt) {
    const SeamModel model = test::model_of(test::line(300), false, 8);
    for (const auto name : kArmNames) {
        // The web faces away from the arm, so the torch comes from above and behind.
        const ArmCell cell = cell_with(std::string(name), at(700, -150, 150, 90));
        const PlanOptions options;
        const Plan result = plan({&model, 1}, options, cell);
        ASSERT_TRUE(result.arm.has_value());
        EXPECT_TRUE(result.arm->pass) << result.arm->verdict;
        expect_laws(result, cell, options);
        EXPECT_LT(worst_between(result, cell), 0.2) << name;
        EXPECT_THAT(result.arm->verdict, HasSubstr("makes the travel"));
        // The weld takes the time that the tool's speed asks for.
        const auto& s = result.arm->samples;
        const auto first = std::find_if(s.begin(), s.end(), [](const ArmSample& a) {
            return a.kind == WaypointKind::weld_start && a.waypoint >= 0;
        });
        const auto last =
            std::find_if(s.begin(), s.end(), [](const ArmSample& a) { return a.kind == WaypointKind::weld_end; });
        EXPECT_NEAR(last->time_s - first->time_s, 300 / 8.0, 1e-6);
    }
}

TEST(ArmTravel, ClosedSeamsAndSeveralSeamsAndPasses) {
    const test::Course beside = test::moved(test::line(150), Isometry3d(Eigen::Translation3d(-75, 110, 0)));
    const std::vector<SeamModel> models{test::model_of(test::circle(60), true, 64), test::model_of(beside, false, 8)};
    for (const auto* name : {"abb-irb-1600-8-1.45", "ur10e", "kuka-kr-16-2"}) {
        const ArmCell cell = cell_with(name, at(850, 0, 200));
        PlanOptions options;
        options.groove = GrooveForm::fillet;
        options.groove_depth_mm = 8;
        options.bead_area_mm2 = 25;
        const Plan result = plan(models, options, cell);
        ASSERT_TRUE(result.arm->pass) << name << ": " << result.arm->verdict;
        expect_laws(result, cell, options);
        EXPECT_GT(std::count_if(result.arm->samples.begin(), result.arm->samples.end(),
                                [](const ArmSample& s) { return s.kind == WaypointKind::air; }),
                  10);
    }
}

// A thousand short seams, a fifth of them in each of five tests that can run side by side, anywhere about the arms:
// either all that is promised holds, or the plan says why not and has not been touched.
class ArmLaws : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Seeds, ArmLaws, testing::Range(11, 16));

TEST_P(ArmLaws, HoldForTwoHundredSeams) {
    std::mt19937_64 generator(static_cast<std::uint64_t>(GetParam()));
    const auto uniform = [&](double low, double high) {
        return low + (high - low) * std::generate_canonical<double, 53>(generator);
    };
    const std::vector<SeamModel> models{
        test::model_of(test::line(60), false, 8), test::model_of(test::circle(12), true, 32),
        test::model_of(test::helix(15, 8), false, 60), test::model_of(test::s_curve(60, 6), false, 40)};
    std::array<ArmCell, kArmNames.size()> cells;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        cells[i] = cell_with(std::string(kArmNames[i]), Isometry3d::Identity());
    }
    int made = 0, turned = 0, refused = 0;
    for (int k = 0; k < 200; ++k) {
        ArmCell& cell = cells[static_cast<std::size_t>(k) % cells.size()];
        const double round = uniform(-kPi, kPi), out = uniform(600, 950);
        cell.base_from_scan = Eigen::Translation3d(out * std::cos(round), out * std::sin(round), uniform(0, 450)) *
                              Eigen::AngleAxisd(uniform(-kPi, kPi), Vector3d::UnitZ()) *
                              Eigen::AngleAxisd(uniform(-0.4, 0.4), Vector3d::UnitX());
        const SeamModel& model = models[static_cast<std::size_t>(k / 5) % models.size()];
        PlanOptions options;
        options.arm_roll_deg = std::array{0.0, 30.0, 60.0}[static_cast<std::size_t>(k) % 3];
        options.travel_angle_deg = uniform(-15, 15);
        const Plan without = plan({&model, 1}, options);
        const Plan with = plan({&model, 1}, options, cell);
        ASSERT_TRUE(with.arm.has_value());
        ASSERT_FALSE(with.arm->verdict.empty());
        if (with.arm->samples.empty()) {
            ++refused;
            EXPECT_FALSE(with.arm->pass);
            EXPECT_THAT(with.arm->verdict, AllOf(HasSubstr("can't make seam 0: at "), HasSubstr("station ")));
            ASSERT_EQ(with.waypoints.size(), without.waypoints.size());
            for (std::size_t i = 0; i < with.waypoints.size(); ++i) {
                ASSERT_EQ(with.waypoints[i].q.coeffs(), without.waypoints[i].q.coeffs());
            }
            continue;
        }
        ++made;
        turned += with.arm->max_roll > 0 ? 1 : 0;
        ASSERT_NO_FATAL_FAILURE(expect_laws(with, cell, options)) << k << ": " << with.arm->verdict;
        if (options.arm_roll_deg == 0) {
            ASSERT_EQ(with.arm->max_roll, 0);
        }
        EXPECT_NEAR(with.duration_s, without.duration_s, 1e-6);
    }
    std::cout << made << " made, " << turned << " of them with the torch turned, " << refused << " refused\n";
    EXPECT_GT(made, 100);
    EXPECT_GT(turned, 20);
    EXPECT_GT(refused, 10);
}

TEST(ArmTravel, SaysWhereItFailsAndWhatWouldHelp) {
    const SeamModel model = test::model_of(test::line(200), false, 8);
    ArmCell cell = cell_with("abb-irb-1600-6-1.2", at(1600, -100, 100, 90));
    const PlanOptions options;
    Plan result = plan({&model, 1}, options, cell);
    ASSERT_FALSE(result.arm->pass);
    EXPECT_TRUE(result.arm->samples.empty());
    EXPECT_THAT(result.arm->verdict,
                AllOf(HasSubstr("IRB 1600-6/1.2 can't make seam 0: at "), HasSubstr("; with the part moved by ")));
    ASSERT_TRUE(result.arm->shift_mm.has_value());
    const Vector3d shift = *result.arm->shift_mm;
    EXPECT_LT(shift.norm(), 500);
    cell.base_from_scan.pretranslate(shift);
    result = plan({&model, 1}, options, cell);
    EXPECT_TRUE(result.arm->pass) << result.arm->verdict;
    // Half of it does not do: the shift is no larger than needed, in its direction.
    cell.base_from_scan.pretranslate(Vector3d(-0.5 * shift));
    EXPECT_FALSE(plan({&model, 1}, options, cell).arm->pass);
    // Far outside nothing helps.
    cell.base_from_scan = at(9000, 0, 0);
    result = plan({&model, 1}, options, cell);
    EXPECT_THAT(result.arm->verdict, AllOf(HasSubstr("out of the arm's reach"), HasSubstr("no move of the part")));
}

// Round a pipe, the torch nearly upright, axis 6 has to turn all the way; where it can't, the wire must take up the
// rest.
TEST(ArmTravel, RollsWhereOneRollWontDo) {
    std::string text = load_arm("abb-irb-1600-8-1.45").text;
    const std::string limits = "lower=\"-6.981317007977318\" upper=\"6.981317007977318\"";
    ASSERT_NE(text.find(limits), std::string::npos);
    text.replace(text.find(limits), limits.size(), "lower=\"-2\" upper=\"2\"");
    ArmCell cell = cell_with("abb-irb-1600-8-1.45", at(850, 0, 200));
    cell.arm = arm_from_urdf(text, "short.urdf");
    cell.flange_from_tool = Eigen::Translation3d(0, 0, 250);  // the wire in line with axis 6
    const SeamModel model = test::model_of(test::circle(60), true, 64);
    PlanOptions options;
    options.work_angle_deg = -40;
    options.arm_roll_deg = 0;
    EXPECT_FALSE(plan({&model, 1}, options, cell).arm->pass);
    options.arm_roll_deg = 180;
    const Plan result = plan({&model, 1}, options, cell);
    ASSERT_TRUE(result.arm->pass) << result.arm->verdict;
    expect_laws(result, cell, options);
    EXPECT_GT(result.arm->max_roll, 20 * kDegree);
    double least = 1e9, most = -1e9;
    for (const ArmSample& s : result.arm->samples) {
        least = std::min(least, s.roll);
        most = std::max(most, s.roll);
    }
    EXPECT_GT(most - least, 30 * kDegree) << "the roll changes along the way";
    // Waypoints came in between, on the moves that were there.
    const Plan before = plan({&model, 1}, options);
    EXPECT_GT(result.waypoints.size(), before.waypoints.size());
    for (const Waypoint& w : result.waypoints) {
        double nearest = 1e9;
        for (std::size_t k = 1; k < before.waypoints.size(); ++k) {
            nearest = std::min(nearest, distance_to_segment(w.p, before.waypoints[k - 1].p, before.waypoints[k].p));
        }
        EXPECT_LT(nearest, 1e-9);
    }
    EXPECT_NEAR(result.duration_s, before.duration_s, 1e-6);
}

// A wrist that bends a degree less than the planned torch asks of it: leaned ahead or back, it need not.
TEST(ArmTravel, ChangesTheTravelAngleWhereThatHelps) {
    const SeamModel model = test::model_of(test::line(120), false, 4);
    ArmCell cell = cell_with("abb-irb-1600-8-1.45", at(850, 0, 200));
    PlanOptions options;
    options.arm_roll_deg = 0;
    const Plan free = plan({&model, 1}, options, cell);
    ASSERT_TRUE(free.arm->pass) << free.arm->verdict;
    double bend = 0;
    for (const ArmSample& s : free.arm->samples) {
        bend = std::max(bend, std::abs(s.q[4]));
    }
    std::string text = load_arm("abb-irb-1600-8-1.45").text;
    const std::string limits = "lower=\"-2.007128639793479\" upper=\"2.007128639793479\"";
    ASSERT_NE(text.find(limits), std::string::npos);
    const std::string least = std::to_string(bend - kDegree);
    text.replace(text.find(limits), limits.size(), "lower=\"-" + least + "\" upper=\"" + least + "\"");
    cell.arm = arm_from_urdf(text, "stiff.urdf");
    EXPECT_FALSE(plan({&model, 1}, options, cell).arm->pass);
    options.arm_travel_angle_deg = 20;
    const Plan result = plan({&model, 1}, options, cell);
    ASSERT_TRUE(result.arm->pass) << result.arm->verdict;
    expect_laws(result, cell, options);
    for (const TravelSample& s : result.travel) {
        EXPECT_GE(std::abs(s.travel_rad), 5 * kDegree - 1e-9);
        EXPECT_LE(std::abs(s.travel_rad), 20 * kDegree + 1e-9);
    }
}

TEST(ArmTravel, LeadsBelongToTheWay) {
    const SeamModel model = test::model_of(test::line(120), false, 4);
    const ArmCell cell = cell_with("abb-irb-1600-8-1.45", at(850, 0, 200));
    PlanOptions options;
    options.lead_in_mm = 15;
    options.lead_out_mm = 10;
    const Plan result = plan({&model, 1}, options, cell);
    ASSERT_TRUE(result.arm->pass) << result.arm->verdict;
    expect_laws(result, cell, options);
    EXPECT_EQ(result.arm->samples.front().waypoint, 0);
    EXPECT_EQ(result.arm->samples.back().waypoint, static_cast<int>(result.waypoints.size()) - 1);
}

TEST(ArmTravel, RefusesMoreThanTheAxesCanAccelerate) {
    const SeamModel model = test::model_of(test::circle(20), true, 64);
    const ArmCell cell = cell_with("abb-irb-1600-6-1.2", at(750, 0, 200));
    PlanOptions options;
    options.speed_mm_s = 60;
    options.arm_acceleration_deg_s2 = {20, 20, 20, 40, 40, 40};
    const Plan result = plan({&model, 1}, options, cell);
    EXPECT_FALSE(result.arm->pass);
    EXPECT_FALSE(result.arm->samples.empty());
    ASSERT_THAT(result.arm->verdict,
                AllOf(HasSubstr("reaches all of the travel"), HasSubstr("too much: plan.speed_mm_s of ")));
    // At the speed that it names, it can.
    const auto at = result.arm->verdict.find("speed_mm_s of ") + 14;
    options.speed_mm_s = std::stod(result.arm->verdict.substr(at));
    EXPECT_TRUE(plan({&model, 1}, options, cell).arm->pass);
}

// Against a brute-force look at every limit, at many more times than joint_move() hands out.
TEST(JointMove, IsTheShortestWithinItsLimits) {
    const Arm arm = load_arm("ur10e").arm;
    const JointAngles acceleration = test::degrees(300, 300, 300, 600, 600, 600);
    std::mt19937_64 generator(5);
    for (int k = 0; k < 50; ++k) {
        std::vector<JointAngles> points{test::random_posture(arm, generator), test::random_posture(arm, generator)};
        if (k % 2 == 1) {
            points.insert(points.begin() + 1,
                          0.5 * (points[0] + points[1]) + 0.1 * test::random_posture(arm, generator));
        }
        const planning::JointMove move = planning::joint_move(arm, points, acceleration);
        ASSERT_EQ(move.q.size(), move.time_s.size());
        EXPECT_EQ(move.q.front(), points.front());
        EXPECT_EQ(move.q.back(), points.back());
        double speed = 0, accelerated = 0;
        for (std::size_t i = 1; i + 1 < move.q.size(); ++i) {
            const double h0 = move.time_s[i] - move.time_s[i - 1], h1 = move.time_s[i + 1] - move.time_s[i];
            for (int axis = 0; axis < kArmAxes; ++axis) {
                const double v0 = (move.q[i][axis] - move.q[i - 1][axis]) / h0,
                             v1 = (move.q[i + 1][axis] - move.q[i][axis]) / h1;
                speed = std::max(speed, std::abs(v0) / arm.axes[static_cast<std::size_t>(axis)].max_speed);
                accelerated = std::max(accelerated, 2 * std::abs(v1 - v0) / (h0 + h1) / acceleration[axis]);
            }
            EXPECT_GE(limit_margin(arm, move.q[i]), 0);
        }
        EXPECT_LE(speed, 1.001);
        EXPECT_LE(accelerated, 1.02);
        EXPECT_GT(std::max(speed, accelerated), 0.9) << "no slower than it must";
    }
}

}  // namespace arm_test
}  // namespace seampath
