#include <algorithm>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/error.hpp"
#include "stages/export/format.hpp"
#include "stages/geometry/pose.hpp"
#include "stages/plan/plan.hpp"
#include "tests/export/plans.hpp"
#include "tests/plan/models.hpp"

/// What all robot languages have in common, and what is each one's own.
namespace seampath {
namespace brands_test {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::ThrowsMessage;

constexpr double kDeg = std::numbers::pi / 180;

std::vector<ProgramFile> programs(const Plan& plan, const std::string& robot,
                                  ExportOptions options = test::cell_options()) {
    options.robots = robot;
    return export_programs(plan, options);
}

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t n = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) {
        ++n;
    }
    return n;
}

class EveryRobot : public testing::TestWithParam<std::string_view> {
protected:
    std::string robot() const { return std::string(GetParam()); }
};
INSTANTIATE_TEST_SUITE_P(Export, EveryRobot, testing::ValuesIn(kRobotNames),
                         [](const auto& tested) { return std::string(tested.param); });

// Each program is read back inside, and refused where an orientation is off by more than 0.001 deg.
TEST_P(EveryRobot, HoldsRotationsThatHaveUndoneOthers) {
    const std::vector<Eigen::Quaterniond> all{Eigen::Quaterniond::Identity(),
                                              Eigen::Quaterniond(0, 1, 0, 0),  // straight down
                                              Eigen::Quaterniond(0, 0, 1, 0),
                                              Eigen::Quaterniond(0, 0, 0, 1),
                                              Eigen::Quaterniond(0, 1, 1, 1).normalized(),
                                              from_euler_zyx(-30 * kDeg, -20 * kDeg, -170 * kDeg),
                                              from_euler_zyx(0, 90 * kDeg, 0),  // gimbal
                                              from_euler_zyx(0, -90 * kDeg, 0),
                                              from_euler_zyx(17 * kDeg, 90 * kDeg, 3 * kDeg),
                                              from_euler_zyx(33.33333 * kDeg, -89.9999999 * kDeg, 77.77777 * kDeg),
                                              from_euler_zyx(12.3454999 * kDeg, 89.9996 * kDeg, -12.3454999 * kDeg),
                                              from_euler_zyx(180 * kDeg, 45 * kDeg, 180 * kDeg),
                                              from_euler_zyx(-179.99999 * kDeg, 0, 179.99999 * kDeg),
                                              from_euler_zyx(0, 0, 0.2 * kDeg),
                                              from_euler_zyx(0, 0, 179.8 * kDeg)};
    for (const Eigen::Quaterniond& q : all) {
        for (const double sign : {1.0, -1.0}) {
            const auto files = programs(test::plan_with(Eigen::Quaterniond(sign * q.coeffs())), robot());
            EXPECT_LE(files.at(0).max_orientation_error_deg, 0.001);
        }
    }
}

// About Z, from 170 deg through 180 to 190 and back: no angle of Rz Ry Rx may jump in between.
Plan turning_plan() {
    std::vector<Waypoint> waypoints;
    for (int k = 0; k <= 22; ++k) {
        const double z = 170 + 2 * (k <= 11 ? k : 22 - k);
        const WaypointKind kind = k == 0    ? WaypointKind::approach
                                  : k == 1  ? WaypointKind::weld_start
                                  : k == 21 ? WaypointKind::weld_end
                                  : k == 22 ? WaypointKind::retract
                                            : WaypointKind::weld;
        waypoints.push_back(test::waypoint(0, kind, k, Eigen::Vector3d(10.0 * k, 0, 0),
                                           from_euler_zyx(z * kDeg, 10 * kDeg, 178 * kDeg), 10));
    }
    return test::finished(waypoints);
}

TEST_P(EveryRobot, TurnsThroughHalfATurn) {
    const Plan plan = turning_plan();
    for (const bool arcs : {true, false}) {
        ExportOptions options = test::arc_options();
        options.arc_moves = arcs;
        for (const ProgramFile& file : programs(plan, robot(), options)) {
            EXPECT_LE(file.max_orientation_error_deg, 0.001);
            EXPECT_LE(file.max_path_turn_deg, options.arc_tolerance_deg + 0.002);
        }
    }
}

TEST_P(EveryRobot, HoldsArcsOfEverySizeWithinTheirTolerance) {
    std::mt19937_64 generator(11);
    const bool arcs =
        std::find(kRobotNames.begin(), kRobotNames.end(), robot()) != kRobotNames.end() &&
        exporting::format(
            static_cast<std::size_t>(std::find(kRobotNames.begin(), kRobotNames.end(), robot()) - kRobotNames.begin()))
            .arcs;
    for (int i = 0; i < 25; ++i) {
        const Plan plan = test::random_helix(generator);
        const auto files = programs(plan, robot(), test::arc_options());
        EXPECT_LE(files[0].max_path_error_mm, 0.02 + 0.005);
        EXPECT_LE(files[0].max_path_turn_deg, 0.1 + 0.002);
        if (arcs) {
            EXPECT_LT(files[0].moves, plan.waypoints.size() / 3) << i << ": fewer points";
        }
    }
}

TEST_P(EveryRobot, TakesFewerPointsForPlannedSeams) {
    const std::vector<SeamModel> models{test::model_of(test::circle(40), true, 64)};
    const Plan planned = plan(models, {});
    ExportOptions options = test::arc_options();
    const std::size_t with = programs(planned, robot(), options)[0].moves;
    options.arc_moves = false;
    const std::size_t without = programs(planned, robot(), options)[0].moves;
    EXPECT_LE(with, without);
    if (robot() != "noether") {
        EXPECT_EQ(with < without, with < planned.waypoints.size());
    }
}

// Numbers of the reference rotation, computed alike by three independent programs.
TEST(Brands, WriteTheReferenceRotation) {
    const Plan plan = test::plan_with(from_euler_zyx(-30 * kDeg, -20 * kDeg, -170 * kDeg));
    const auto kuka = programs(plan, "kuka");
    EXPECT_EQ(kuka.at(1).file_name, "seampath.dat");
    EXPECT_THAT(kuka.at(1).content,
                HasSubstr("DECL FRAME P1={X 25.123,Y 10.568,Z -1.250,A -30.0000,B -20.0000,C -170.0000}\r\n"));
    EXPECT_THAT(
        programs(plan, "fanuc").at(0).content,
        HasSubstr("P[2]{\r\n   GP1:\r\n\tUF : 1, UT : 2,\t\tCONFIG : 'N U T, 0, 0, 0',\r\n\tX =    25.123  mm,\tY = "
                  "   10.568  mm,\tZ =    -1.250  mm,\r\n\tW =  -170.000 deg,\tP =   -20.000 deg,\tR =   "
                  "-30.000 deg\r\n};\r\n"));
    EXPECT_THAT(programs(plan, "linuxcnc").at(0).content,
                HasSubstr("X25.1234 Y10.5678 Z-1.2500 A-170.00000 B-20.00000 C-30.00000"));
    EXPECT_THAT(programs(plan, "yaskawa").at(0).content,
                HasSubstr("C00001=25.123,10.568,-1.250,-170.0000,-20.0000,-30.0000\r\n"));
}

TEST(Brands, FanucTakesTheUnitThatHoldsTheSpeed) {
    const auto speed_of = [](double mm_s) {
        const std::string text = programs(test::plan_with(Eigen::Quaterniond(0, 1, 0, 0), mm_s), "fanuc")[0].content;
        const auto at = text.find("L P[3] ");
        return text.substr(at + 7, text.find(' ', at + 7) - at - 7);
    };
    EXPECT_EQ(speed_of(8), "8mm/sec");
    EXPECT_EQ(speed_of(8.5), "51cm/min");
    EXPECT_EQ(speed_of(8.3), "50cm/min") << "0.4 % off";
    EXPECT_EQ(speed_of(1.23), "8130msec") << "10 mm";
    EXPECT_EQ(speed_of(0.5), "3cm/min");
    EXPECT_THAT([&] { speed_of(0.031); },
                ThrowsMessage<InputError>(AllOf(HasSubstr("export: fanuc: waypoint 2 of seam 0 has a speed of 0.031"),
                                                HasSubstr("plan.speed_mm_s"))));
    EXPECT_THROW(speed_of(2500), InputError);
}

TEST(Brands, YaskawaRefusesSpeedsBetweenItsSteps) {
    ExportOptions options = test::cell_options();
    const Plan plan = test::plan_with(Eigen::Quaterniond(0, 1, 0, 0), 8.5);
    options.yaskawa_speed_unit = "mm/s";
    EXPECT_THAT(programs(plan, "yaskawa", options)[0].content, HasSubstr("V=8.5 "));
    options.yaskawa_speed_unit = "cm/min";
    EXPECT_THAT(programs(plan, "yaskawa", options)[0].content, HasSubstr("V=51.0 "));
    options.yaskawa_speed_unit = "m/min";
    EXPECT_THAT(programs(plan, "yaskawa", options)[0].content, HasSubstr("V=0.51 "));
    options.yaskawa_speed_unit = "inch/min";
    EXPECT_THAT(programs(plan, "yaskawa", options)[0].content, HasSubstr("V=20.1 "));
    options.yaskawa_speed_unit = "mm/s";
    EXPECT_THAT([&] { programs(test::plan_with(Eigen::Quaterniond(0, 1, 0, 0), 1.25), "yaskawa", options); },
                ThrowsMessage<InputError>(AllOf(HasSubstr("a speed of 1.25 mm/s"), HasSubstr("steps of 0.1 mm/s"))));
}

TEST(Brands, KukaWeldsInSplineBlocksOnRequest) {
    ExportOptions options = test::arc_options();
    options.kuka_spline = true;
    const std::string text = programs(test::golden_plan(), "kuka", options)[0].content;
    EXPECT_EQ(count(text, "SPLINE WITH $VEL.CP="), 2u);
    EXPECT_EQ(count(text, "ENDSPLINE\r\n"), 2u);
    EXPECT_EQ(count(text, "SLIN P"), 8u);
    EXPECT_THAT(text, Not(HasSubstr("C_DIS")));
    EXPECT_THAT(text, HasSubstr("SPLINE WITH $VEL.CP=0.0085\r\nSLIN P2\r\nSLIN P3\r\nSLIN P4\r\nENDSPLINE\r\n"
                                "WAIT SEC 0\r\nArcOff()\r\n"));
}

TEST(Brands, WeldsAsEachBrandWritesThem) {
    const Plan plan = test::golden_plan();
    const ExportOptions options = test::arc_options();
    EXPECT_EQ(count(programs(plan, "kuka", options)[0].content, "WAIT SEC 0\r\nArcOn()\r\n"), 2u);
    const std::string fanuc = programs(plan, "fanuc", options)[0].content;
    EXPECT_EQ(count(fanuc, "FINE\r\n    :  Arc Start[6]    ;\r\n"), 2u);
    EXPECT_EQ(count(fanuc, "FINE\r\n    :  Arc End[7]    ;\r\n"), 2u);
    EXPECT_EQ(count(fanuc, ":  Weave Sine[8] ;\r\n"), 2u);
    EXPECT_EQ(count(fanuc, ":  Weave End ;\r\n"), 2u);
    const std::string yaskawa = programs(plan, "yaskawa", options)[0].content;
    EXPECT_EQ(count(yaskawa, "PL=0\r\nARCON ASF#(4)\r\nWVON WEV#(9)\r\n"), 2u);
    EXPECT_EQ(count(yaskawa, "PL=0\r\nWVOF\r\nARCOF AEF#(5)\r\n"), 2u);
    for (const char* robot : {"kuka", "fanuc", "yaskawa"}) {
        const std::string text = programs(plan, robot)[0].content;
        EXPECT_THAT(text, AllOf(Not(HasSubstr("ARCO")), Not(HasSubstr("Arc ")), Not(HasSubstr("ArcO")))) << robot;
    }
}

// Of many points that no arc or longer line can stand for.
Plan rough_plan(int seams, int points) {
    return test::side_by_side(seams, points, [](int k) { return Eigen::Vector3d(0.5 * k, 0.5 * (k % 2), 0); });
}

TEST(Brands, SplitLongProgramsBetweenWelds) {
    struct Limit {
        const char* robot;
        std::size_t lines, files_per_part;
        std::string start, end, call;
    };
    for (const Limit& limit : {Limit{"kuka", 1400, 2, "ArcOn()", "ArcOff()", "seampath_1()"},
                               Limit{"fanuc", 9999, 1, "Arc Start", "Arc End", "CALL SEAMPATH_1"},
                               Limit{"yaskawa", 2000, 1, "ARCON", "ARCOF", "CALL JOB:SEAMPATH_1"}}) {
        const int points = static_cast<int>(limit.lines / 5 * 2);
        const auto files = programs(rough_plan(5, points), limit.robot, test::arc_options());
        ASSERT_EQ(files.size(), limit.files_per_part * 4) << limit.robot << ": a main and three parts";
        EXPECT_EQ(count(files[0].content, limit.call), 1u);
        EXPECT_EQ(count(files[0].content, limit.start), 0u);
        for (const ProgramFile& file : files) {
            EXPECT_EQ(count(file.content, limit.start), count(file.content, limit.end)) << file.file_name;
            EXPECT_LE(count(file.content, "\n"), limit.lines * 7) << file.file_name;
        }
        const int too_many = static_cast<int>(limit.lines) + 1;
        EXPECT_THAT([&] { programs(rough_plan(1, too_many), limit.robot); },
                    ThrowsMessage<InputError>(AllOf(HasSubstr("seam 0 makes"), HasSubstr("a weld is not split"))));
    }
}

struct Bad {
    std::string robot, problem;
    std::function<void(ExportOptions&)> make;
};

TEST(Brands, SayWhichKeySetsWhatIsMissing) {
    const std::vector<Bad> all{
        {"kuka", "kuka_tool: no number of a tool was given", [](auto& o) { o.kuka_tool.reset(); }},
        {"kuka", "kuka_base: 1.5 is no number of a base", [](auto& o) { o.kuka_base = 1.5; }},
        {"kuka", "kuka_arc_on: \"\" and kuka_arc_off \"x\"; both", [](auto& o) { o.kuka_arc_off = "x"; }},
        {"kuka", "three different names were needed", [](auto& o) { o.kuka_arc_on = "weld", o.kuka_arc_off = "Weld"; }},
        {"kuka", "kuka_arc_on: \"WAIT\" is a word of KRL",
         [](auto& o) { o.kuka_arc_on = "WAIT", o.kuka_arc_off = "x"; }},
        {"kuka", "at most 20 are needed", [](auto& o) { o.program_name = std::string(21, 'a'); }},
        {"kuka", "program_name: \"Schwei\xC3\x9Fnaht\" is no name",
         [](auto& o) { o.program_name = "Schwei\xC3\x9Fnaht"; }},
        {"fanuc", "fanuc_tool: no number of a tool frame was given", [](auto& o) { o.fanuc_tool.reset(); }},
        {"fanuc", "fanuc_user_frame: no number", [](auto& o) { o.fanuc_user_frame.reset(); }},
        {"fanuc", "fanuc_configuration: \"\" is no configuration", [](auto& o) { o.fanuc_configuration = ""; }},
        {"fanuc", "is no configuration", [](auto& o) { o.fanuc_configuration = "N U T, 0, 0"; }},
        {"fanuc", "is no configuration", [](auto& o) { o.fanuc_configuration = "N U T, 0, 0, 0, 0"; }},
        {"fanuc", "fanuc_arc_end: no weld schedule was given", [](auto& o) { o.fanuc_arc_start = 1; }},
        {"fanuc", "fanuc_arc_start: no weld schedule was given", [](auto& o) { o.fanuc_arc_end = 1; }},
        {"fanuc", "fanuc_weave: stands alone", [](auto& o) { o.fanuc_weave = 1; }},
        {"fanuc", "joint_speed_percent: 10.5 is no share", [](auto& o) { o.joint_speed_percent = 10.5; }},
        {"fanuc", "has 40 characters", [](auto& o) { o.program_name = std::string(40, 'a'); }},
        {"yaskawa", "yaskawa_tool: no number of a tool", [](auto& o) { o.yaskawa_tool.reset(); }},
        {"yaskawa", "yaskawa_speed_unit: \"\" is no unit of V=", [](auto& o) { o.yaskawa_speed_unit = ""; }},
        {"yaskawa", "yaskawa_configuration: \"1,0\" is no RCONF", [](auto& o) { o.yaskawa_configuration = "1,0"; }},
        {"yaskawa", "yaskawa_configuration: \"1,0,0,0,0,2\"", [](auto& o) { o.yaskawa_configuration = "1,0,0,0,0,2"; }},
        {"yaskawa", "yaskawa_arc_end: no arc end file", [](auto& o) { o.yaskawa_arc_start = 1; }},
        {"yaskawa", "yaskawa_weave: stands alone", [](auto& o) { o.yaskawa_weave = 1; }},
        {"linuxcnc", "linuxcnc_arc_output: 64 is no digital output", [](auto& o) { o.linuxcnc_arc_output = 64; }},
        {"linuxcnc", "linuxcnc_work_offset: 10", [](auto& o) { o.linuxcnc_work_offset = 10; }},
        {"ros", "ros_frame: \"base link\" is no frame", [](auto& o) { o.ros_frame = "base link"; }},
        {"abb", "abb_weld_data: \"Speed0\" is a name that the program itself declares",
         [](auto& o) { o.abb_seam_data = "s", o.abb_weld_data = "Speed0"; }},
        {"abb", "abb_tool: \"seampath_seam3\" is a name that", [](auto& o) { o.abb_tool = "seampath_seam3"; }},
        {"abb", "program_name: \"speed2\" is what", [](auto& o) { o.program_name = "speed2"; }},
        {"kuka", "none as the program's points", [](auto& o) { o.kuka_arc_on = "P1", o.kuka_arc_off = "x"; }},
        {"kuka", "none as the program's points", [](auto& o) { o.kuka_arc_on = "x", o.kuka_arc_off = "Seampath_0"; }},
        {"kuka", "program_name: \"p7\" is what", [](auto& o) { o.program_name = "p7"; }},
        {"abb", "abb_weave_data: \"w\" stands alone", [](auto& o) { o.abb_weave_data = "w"; }},
    };
    for (const Bad& bad : all) {
        ExportOptions options = test::cell_options();
        options.robots = bad.robot;
        EXPECT_THAT(export_problems(options), testing::IsEmpty());
        bad.make(options);
        EXPECT_THAT(export_problems(options), Contains(HasSubstr(bad.problem)));
        EXPECT_THROW(export_programs(test::golden_plan(), options), InputError) << bad.problem;
    }
}

TEST_P(EveryRobot, TellsTheUncertaintyOfTheFrame) {
    ExportOptions options = test::cell_options();
    options.base_from_scan_sigma_mm = 0.125;
    options.base_from_scan_sigma_deg = 0.0625;
    const Plan plan = test::golden_plan_for(robot());
    // Short comments are broken between words.
    const std::string text = programs(plan, robot(), options)[0].content;
    EXPECT_THAT(text, AllOf(HasSubstr("base_from_scan"), HasSubstr("0.125"), HasSubstr("0.0625"), HasSubstr("sigma")));
    options.base_from_scan_sigma_mm.reset();
    options.base_from_scan_sigma_deg.reset();
    EXPECT_THAT(programs(plan, robot(), options)[0].content, Not(HasSubstr("-sigma of")));
}

// 8.5 mm/s has no whole number of mm/s: another unit, more digits, or as a speed is told there.
TEST_P(EveryRobot, HoldsEightAndAHalfMillimetresASecond) {
    for (const char* unit : {"mm/s", "cm/min", "m/min"}) {
        ExportOptions options = test::cell_options();
        options.yaskawa_speed_unit = unit;
        const auto files = programs(test::plan_with(Eigen::Quaterniond(0, 1, 0, 0), 8.5), robot(), options);
        EXPECT_LE(files[0].max_speed_error, 1e-9);
        EXPECT_THAT(files[0].content, Not(AllOf(HasSubstr("8mm/sec"), HasSubstr("9mm/sec"))));
    }
}

TEST_P(EveryRobot, TakesNamesThatItCanHoldAndNoOthers) {
    ExportOptions options = test::cell_options();
    options.robots = robot();
    options.program_name = std::string(40, 'a');
    const bool nameless = robot() == "csv" || robot() == "json";
    const bool shorter = robot() == "abb" || robot() == "kuka" || robot() == "fanuc" || robot() == "yaskawa";
    if (shorter) {
        EXPECT_THAT(export_problems(options), testing::ElementsAre(HasSubstr("has 40 characters; at most")));
    } else {
        EXPECT_TRUE(nameless || programs(test::golden_plan_for(robot()), robot(), options)[0].file_name.starts_with(
                                    options.program_name));
    }
    options.program_name = "N\xC3\xA4ht";
    EXPECT_EQ(export_problems(options).empty(), nameless) << "a name of letters beyond ASCII";
}

// Text from other files, as an arm's name, stays out of the programs where it is not ASCII.
TEST_P(EveryRobot, StaysInAscii) {
    Plan plan = test::arm_plan();
    plan.arm->arm = "Roboter f\xC3\xBCr N\xC3\xA4hte\nEND";
    if (robot() == "linuxcnc") {
        plan = test::golden_plan_for(robot());
    }
    ExportOptions options = test::arc_options();
    options.arm_robot =
        robot() == "csv" || robot() == "json" || robot() == "linuxcnc" || robot() == "ros" || robot() == "noether"
            ? ""
            : robot();
    for (const ProgramFile& file : programs(plan, robot(), options)) {
        EXPECT_TRUE(file.file_name.ends_with(".mcap") ||
                    std::all_of(file.content.begin(), file.content.end(),
                                [](char c) { return c == '\n' || c == '\r' || c == '\t' || (c >= ' ' && c <= '~'); }))
            << file.file_name;
    }
}

TEST_P(EveryRobot, RefusesPositionsBeyondItsRange) {
    const std::size_t row =
        static_cast<std::size_t>(std::find(kRobotNames.begin(), kRobotNames.end(), robot()) - kRobotNames.begin());
    const double most_mm = exporting::format(row).max_coordinate_mm;
    ExportOptions options = test::cell_options();
    if (!std::isfinite(most_mm)) {
        options.base_from_scan[0] = 1e7;
        EXPECT_LE(programs(test::golden_plan(), robot(), options)[0].max_position_error_mm, 1e-8);
        return;
    }
    // The farthest waypoint lies at x = 35.1234 mm.
    const Plan plan = test::plan_with(Eigen::Quaterniond(0, 1, 0, 0));
    options.base_from_scan[0] = most_mm - 35.1235;
    EXPECT_NO_THROW(programs(plan, robot(), options));
    options.base_from_scan[0] = most_mm - 35.1233;
    EXPECT_THAT([&] { programs(plan, robot(), options); },
                ThrowsMessage<InputError>(
                    AllOf(HasSubstr(robot() + ": waypoint 2 of seam 0 lies at"), HasSubstr("export.base_from_scan"))));
}

}  // namespace brands_test
}  // namespace seampath
