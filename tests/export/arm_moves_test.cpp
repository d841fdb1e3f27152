#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/error.hpp"
#include "stages/export/format.hpp"
#include "stages/geometry/pose.hpp"
#include "stages/plan/plan.hpp"
#include "tests/export/plans.hpp"
#include "tests/geometry/arms.hpp"
#include "tests/plan/models.hpp"

/// Programs of a plan that knows its arm: moves along the axes through the air, and ROS's trajectory of them.
namespace seampath {
namespace arm_moves_test {

using exporting::Axes;
using exporting::Format;
using exporting::Program;
using exporting::Target;
using exporting::TextFile;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

// Half a pulse of the coarsest axis of cell_options(), or half of FANUC's last decimal.
constexpr double kCoarsest_deg = 0.5 / 640 + 1e-9;

ExportOptions options_of(const std::string& robot) {
    ExportOptions options = test::arc_options();
    options.robots = options.arm_robot = robot;
    return options;
}

std::string text_of(const Plan& plan, const ExportOptions& options) {
    std::string text;
    for (const ProgramFile& file : export_programs(plan, options)) {
        text += file.content;
    }
    return text;
}

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t n = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) {
        ++n;
    }
    return n;
}

class ArmMoves : public testing::TestWithParam<const char*> {
protected:
    const ExportOptions options = options_of(GetParam());
    const Format& format() const {
        return exporting::format(static_cast<std::size_t>(
            std::find(kRobotNames.begin(), kRobotNames.end(), std::string_view(GetParam())) - kRobotNames.begin()));
    }
};
INSTANTIATE_TEST_SUITE_P(Export, ArmMoves, testing::Values("abb", "kuka", "fanuc", "ur", "yaskawa"),
                         [](const auto& tested) { return std::string(tested.param); });

TEST_P(ArmMoves, GoThroughTheAirByTheAxes) {
    const Plan plan = test::arm_plan();
    const Program program = program_of(plan, format(), options);
    const std::vector<Target> read = format().read(format().write(program, options));
    ASSERT_EQ(read.size(), program.targets.size());
    std::size_t moves = 0;
    for (std::size_t k = 0; k < read.size(); ++k) {
        const std::size_t waypoint = program.targets[k].waypoint;
        const WaypointKind kind = plan.waypoints[waypoint].kind;
        const bool in_air = kind == WaypointKind::approach || kind == WaypointKind::air;
        ASSERT_EQ(read[k].axes.size(), in_air ? 1u : 0u) << name(kind);
        EXPECT_EQ(read[k].move == exporting::Move::joint, in_air);
        for (const ArmSample& sample : plan.arm->samples) {
            for (std::size_t axis = 0; in_air && sample.waypoint == static_cast<int>(waypoint) && axis < 6; ++axis) {
                EXPECT_NEAR(read[k].axes[0].q[axis], sample.q[axis], kCoarsest_deg * test::kDegree)
                    << "axis " << axis + 1;
            }
        }
        moves += in_air ? 1 : 0;
    }
    EXPECT_EQ(moves, 3u) << "two seams and a point in the air";
}

TEST_P(ArmMoves, AreForThatArmsRobotAlone) {
    Plan plan = test::arm_plan();
    const std::string with = text_of(plan, options);
    ExportOptions other = options;
    other.arm_robot = options.robots == "abb" ? "ur" : "abb";
    const std::string of_another = text_of(plan, other);
    plan.arm.reset();
    EXPECT_EQ(of_another, text_of(plan, other)) << "another robot's axes are none of its business";
    EXPECT_NE(with, of_another);
}

// Parts begin with a move along the axes, each with what it needs.
TEST_P(ArmMoves, GoIntoEveryPartOfALongProgram) {
    Plan plan = test::side_by_side(8, 1300, [](int k) { return Eigen::Vector3d(0.5 * k, 0.5 * (k % 2), 0); });
    ArmTravel arm;
    arm.max_speed = {2, 2, 2, 4, 4, 4};
    for (std::size_t k = 0; k < plan.waypoints.size(); ++k) {
        arm.samples.push_back({plan.waypoints[k].seam,
                               plan.waypoints[k].kind,
                               static_cast<int>(k),
                               0,
                               plan.waypoints[k].time_s,
                               {0.1, 0.2, 0.3, 0.4, -0.5, 0.6},
                               0,
                               0.1});
    }
    plan.arm = arm;
    const auto files = export_programs(plan, options);
    EXPECT_TRUE(files.size() > 2 || options.robots == "ur") << "all others have parts";
    EXPECT_LE(files[0].max_axis_error_deg, kCoarsest_deg);
}

// One digit of an axis more or less: the reading back must notice.
TEST_P(ArmMoves, NoticeAWrongAxis) {
    const Program program = program_of(test::arm_plan(), format(), options);
    const std::vector<TextFile> files = format().write(program, options);
    const std::vector<Target> read = format().read(files);
    const auto told = format().told(options);
    EXPECT_NO_THROW(compare(format(), told, program.targets, read));
    for (std::size_t k = 0; k < read.size(); ++k) {
        for (std::size_t axis = 0; axis < 6 && !read[k].axes.empty(); ++axis) {
            std::vector<Target> changed = read;
            changed[k].axes[0].q[axis] += 0.002 * test::kDegree;
            EXPECT_THROW(compare(format(), told, program.targets, changed), InternalError);
        }
    }
    std::vector<Target> without = read;
    without[0].axes.clear();
    EXPECT_THROW(compare(format(), told, program.targets, without), InternalError);
}

// Any byte of the files made another: they are refused, or say the same as before.
TEST_P(ArmMoves, SurviveAnyDamagedByte) {
    const Program program = program_of(test::arm_plan(), format(), options);
    const std::vector<TextFile> files = format().write(program, options);
    for (std::size_t file = 0; file < files.size(); ++file) {
        for (std::size_t at = 0; at < files[file].text.size(); at += 7) {
            std::vector<TextFile> damaged = files;
            damaged[file].text[at] = "x(-\n\"[;9\xFF"[at % 9];
            try {
                compare(format(), format().told(options), program.targets, format().read(damaged));
            } catch (const InternalError&) {
            }
        }
    }
}

TEST(ArmMovesText, IsWhatEachBrandWrites) {
    const Plan plan = test::arm_plan();
    const std::string abb = text_of(plan, options_of("abb"));
    EXPECT_EQ(count(abb, "MoveAbsJ [["), 3u);
    EXPECT_EQ(count(abb, "MoveJ "), 0u);
    EXPECT_THAT(abb, HasSubstr("MoveAbsJ [[0.0000,-28.6479,85.9437,-14.3239,-71.6197,0.0000],[9E9,9E9,9E9,9E9,9E9,9E9]]"
                               "\\NoEOffs,speed0,fine,tool0\\WObj:=wobj0;"));
    EXPECT_THAT(abb, HasSubstr("Axes are those of Arm 6 standing in that base."));
    const std::string kuka = text_of(plan, options_of("kuka"));
    EXPECT_THAT(kuka, HasSubstr("DECL E6AXIS P0={A1 0.0000,A2 -28.6479,A3 85.9437,A4 -14.3239,A5 -71.6197,A6 0.0000}"));
    EXPECT_EQ(count(kuka, "PTP P"), 3u);
    // The pendant's J3 is the forearm's angle to the floor: 85.944 deg to the upper arm, which leans back by 28.648.
    EXPECT_THAT(text_of(plan, options_of("fanuc")),
                HasSubstr("P[1]{\r\n   GP1:\r\n\tUF : 1, UT : 2,\t\r\n\tJ1=     0.000 deg,\tJ2=   -28.648 deg,\tJ3=   "
                          "114.592 deg,\r\n\tJ4=   -14.324 deg,\tJ5=   -71.620 deg,\tJ6=     0.000 deg\r\n};\r\n"));
    const std::string ur = text_of(plan, options_of("ur"));
    EXPECT_THAT(ur, HasSubstr("movej([0.000000, -0.500000, 1.500000, -0.250000, -1.250000, 0.000000], a=1.4, "
                              "v=0.200000)"));
    EXPECT_THAT(ur, Not(HasSubstr("straight from where")));
    EXPECT_THAT(text_of(plan, options_of("yaskawa")),
                AllOf(HasSubstr("///TOOL 1\r\n///POSTYPE PULSE\r\n///PULSE\r\nC00000=0,37249,122212,-14324,-78979,0\r\n"
                                "///USER 2\r\n///TOOL 1\r\n///POSTYPE USER\r\n///RECTAN\r\n"),
                      HasSubstr("MOVJ C00000 VJ=10.00\r\n")));
}

// Axes of a FANUC on its pendant and where they put the flange, in the frame of J1 and J2, as ROBOGUIDE tells them of
// an arm of 75, 840, 215 and 890 mm and a flange at 90: the program's angles must be the pendant's.
TEST(ArmMovesText, FanucsAxesAreThePendants) {
    Arm arm;
    const auto axis = [](double x, double z, const Eigen::Vector3d& direction) {
        return ArmAxis{"", {x, 0, z}, direction, -10, 10, 1};
    };
    using Eigen::Vector3d;
    arm.axes = {axis(0, 0, Vector3d::UnitZ()),       axis(75, 0, Vector3d::UnitY()),
                axis(75, 840, -Vector3d::UnitY()),   axis(75, 1055, -Vector3d::UnitX()),
                axis(965, 1055, -Vector3d::UnitY()), axis(965, 1055, -Vector3d::UnitX())};
    arm.base_from_flange = Eigen::Translation3d(1055, 0, 1055);
    struct Probe {
        std::array<double, 6> pendant_deg;
        Vector3d flange;
    };
    const std::vector<Probe> probes{{{0, 0, 0, 0, -90, 0}, {965, 0, 965}},
                                    {{0, 0, 0, 185, -90, 0}, {965, 7.844, 1144.657}},
                                    {{0, 40, 60, 0, -90, 0}, {951.688, 0, 1476.740}},
                                    {{0, 40, -60, 0, -90, 0}, {1168.195, 0, -64.785}},
                                    {{0, -60, -80, 0, -90, 0}, {-374.813, 0, -434.773}},
                                    {{-150, 0, 0, 0, -90, 0}, {-835.714, -482.5, 965}}};
    for (const Probe& probe : probes) {
        std::string file =
            "/PROG  P\r\n/ATTR\r\nLINE_COUNT\t= 3;\r\n/MN\r\n   1:  UFRAME_NUM=1 ;\r\n   2:  UTOOL_NUM=2 ;\r\n"
            "   3:J P[1] 10% FINE    ;\r\n/POS\r\nP[1]{\r\n   GP1:\r\n\tUF : 1, UT : 2,\t\r\n\t";
        for (std::size_t i = 0; i < 6; ++i) {
            file += (i == 0 ? "" : ",\t") + std::string("J") + std::to_string(i + 1) + "= " +
                    std::to_string(probe.pendant_deg[i]) + " deg";
        }
        const std::vector<Target> read = exporting::read_fanuc({{"P.ls", file + "\r\n};\r\n/END\r\n"}});
        ASSERT_EQ(read.size(), 1u);
        const Vector3d there = forward(arm, JointAngles(read[0].axes.at(0).q.data())).translation();
        EXPECT_LT((there - probe.flange).cwiseAbs().maxCoeff(), 0.0006) << there.transpose();
        // And back: what is written of those axes is the pendant's.
        Plan plan = test::arm_plan();
        for (ArmSample& sample : plan.arm->samples) {
            sample.q = read[0].axes[0].q;
        }
        const std::string text = text_of(plan, options_of("fanuc"));
        for (std::size_t i = 0; i < 6; ++i) {
            std::string number = std::to_string(probe.pendant_deg[i]);
            number.resize(number.size() - 3);
            EXPECT_THAT(text, testing::ContainsRegex("J" + std::to_string(i + 1) + "= +" + number + " deg"));
        }
    }
}

TEST(ArmMovesText, FanucsConfigurationMustBeTheArms) {
    ExportOptions options = options_of("fanuc");
    Plan plan = test::arm_plan();
    options.fanuc_configuration = "F U T, 0, 0, 0";
    EXPECT_THAT([&] { export_programs(plan, options); },
                ThrowsMessage<InputError>(AllOf(HasSubstr("waypoint 0 of seam 0 with wrist N;"),
                                                HasSubstr("export.fanuc_configuration"), HasSubstr("F U T, 0, 0, 0"))));
    for (ArmSample& sample : plan.arm->samples) {
        sample.q[4] = 0.5;
    }
    EXPECT_NO_THROW(export_programs(plan, options));
    options.fanuc_configuration = "N D B, 0, 0, 1";
    EXPECT_THROW(export_programs(plan, options), InputError);
}

TEST(ArmMovesText, OptionsThatAnArmNeedsNameTheirKeys) {
    ExportOptions options = options_of("yaskawa");
    options.yaskawa_pulses_per_deg = {1, 2, 3};
    EXPECT_THAT(export_problems(options), testing::Contains(HasSubstr("yaskawa_pulses_per_deg: [1, 2, 3]")));
    options = options_of("abb");
    options.arm_robot = "ros";
    EXPECT_THAT(export_problems(options),
                testing::Contains(HasSubstr("arm_robot: \"ros\" has no moves along axes; one of abb, kuka, fanuc, ur, "
                                            "yaskawa was needed")));
    options = test::cell_options();
    options.robots = "ros";
    options.arm_joints = "a,b,c,d,e";
    EXPECT_THAT(export_problems(options), testing::Contains(HasSubstr("arm_joints: \"a,b,c,d,e\" are no joints")));
    options.arm_joints.clear();
    EXPECT_THAT([&] { export_programs(test::arm_plan(), options); },
                ThrowsMessage<InputError>(HasSubstr("export.arm_joints")));
}

TEST(ArmMovesRos, TellTheWholeTravel) {
    const Plan plan = test::arm_plan();
    const ExportOptions options = test::arc_options();
    const Format& format = exporting::kRos;
    const Program program = program_of(plan, format, options);
    const std::vector<TextFile> files = format.write(program, options);
    ASSERT_EQ(files.size(), 4u);
    EXPECT_EQ(files[2].name, "seampath_joints.yaml");
    const std::vector<Target> read = format.read(files);
    std::size_t k = 0;
    for (const Target& target : read) {
        for (const exporting::AxisPoint& point : target.axes) {
            const ArmSample& sample = plan.arm->samples.at(k);
            EXPECT_NEAR(point.time_s, sample.time_s, 1e-9);
            for (std::size_t axis = 0; axis < 6; ++axis) {
                EXPECT_NEAR(point.q[axis], sample.q[axis], 1e-12);
                const bool rests =
                    sample.waypoint >= 0 && sample.kind != WaypointKind::weld && sample.kind != WaypointKind::air;
                if (rests) {
                    EXPECT_EQ(point.dq[axis], 0);
                }
            }
            ++k;
        }
    }
    EXPECT_EQ(k, plan.arm->samples.size());
    EXPECT_NO_THROW(compare(format, format.told(options), program.targets, read));
    for (const auto& change : std::vector<std::function<void(exporting::AxisPoint&)>>{
             [](auto& p) { p.q[2] += 2e-5; }, [](auto& p) { p.dq[5] += 1e-6; }, [](auto& p) { p.time_s += 1e-6; }}) {
        std::vector<Target> changed = read;
        change(changed[5].axes[0]);
        EXPECT_THROW(compare(format, format.told(options), program.targets, changed), InternalError);
    }
}

// Speeds are the slopes of the way: of an arm whose axes go evenly, the same all along.
TEST(ArmMovesRos, SpeedsAreTheSlopesOfTheAngles) {
    Plan plan = test::arm_plan();
    for (ArmSample& sample : plan.arm->samples) {
        for (std::size_t axis = 0; axis < 6; ++axis) {
            const double t = sample.time_s;
            sample.q[axis] = 0.1 * static_cast<double>(axis) * t - 0.01 * t * t;
        }
    }
    const Program program = program_of(plan, exporting::kRos, test::arc_options());
    std::size_t moving = 0;
    for (const Target& target : program.targets) {
        for (const exporting::AxisPoint& point : target.axes) {
            for (std::size_t axis = 0; axis < 6; ++axis) {
                if (point.dq[axis] != 0) {
                    EXPECT_NEAR(point.dq[axis], 0.1 * static_cast<double>(axis) - 0.02 * point.time_s, 1e-9);
                    ++moving;
                }
            }
        }
    }
    EXPECT_GT(moving, 100u);
}

// A planned travel of a real arm, two seams and the air between them.
TEST(ArmMovesRos, PlannedTravelsComeBack) {
    const std::vector<SeamModel> models{
        test::model_of(test::line(60), false, 8),
        test::model_of(test::moved(test::line(60), Eigen::Isometry3d(Eigen::Translation3d(0, 120, 0))), false, 8)};
    ArmCell cell{load_arm("ur10e").arm, Eigen::Isometry3d(Eigen::Translation3d(700, 0, 200)),
                 Eigen::Isometry3d::Identity()};
    const Plan planned = plan(models, {}, cell);
    ASSERT_TRUE(planned.arm->pass) << planned.arm->verdict;
    ExportOptions options = options_of("ur");
    options.robots = "ur,ros";
    options.base_from_scan = {700, 0, 200, 1, 0, 0, 0};
    for (const ProgramFile& file : export_programs(planned, options)) {
        EXPECT_LT(file.max_axis_error_deg, 3e-5) << file.file_name;
    }
}

}  // namespace arm_moves_test
}  // namespace seampath
