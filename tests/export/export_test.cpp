#include "stages/export/export.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "stages/error.hpp"
#include "stages/export/format.hpp"
#include "stages/export/text.hpp"
#include "stages/geometry/pose.hpp"
#include "stages/plan/plan.hpp"
#include "tests/export/plans.hpp"
#include "tests/plan/models.hpp"

namespace seampath {
namespace export_test {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::ThrowsMessage;

constexpr double kDeg = std::numbers::pi / 180;

std::string program(const Plan& plan, const std::string& robot, ExportOptions options = {}) {
    options.robots = robot;
    const std::vector<ProgramFile> files = export_programs(plan, options);
    EXPECT_FALSE(files.empty());
    return files.at(0).content;
}

std::vector<std::string> lines_with(const std::string& text, const std::string& part) {
    std::vector<std::string> found;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) {
        if (line.find(part) != std::string::npos) {
            found.push_back(line);
        }
    }
    return found;
}

std::vector<double> numbers_in(const std::string& text) {
    std::vector<double> result;
    const char* const end = text.data() + text.size();
    for (const char* at = text.data(); at != end;) {
        double value = 0;
        const auto [behind, error] = std::from_chars(at, end, value);
        if (error == std::errc() && std::isfinite(value)) {
            result.push_back(value);
        }
        at = error == std::errc() ? behind : at + 1;
    }
    return result;
}

// Every rotation that has undone an exporter: on each target the pose must come out as it went in.
struct Rotation {
    std::string name;
    Eigen::Quaterniond q;
    Eigen::Vector3d vector;  // of URScript, rad

    friend void PrintTo(const Rotation& r, std::ostream* out) { *out << r.name; }
};

Eigen::Quaterniond zyx(double z_deg, double y_deg, double x_deg) {
    return Eigen::AngleAxisd(z_deg * kDeg, Eigen::Vector3d::UnitZ()) *
           Eigen::AngleAxisd(y_deg * kDeg, Eigen::Vector3d::UnitY()) *
           Eigen::AngleAxisd(x_deg * kDeg, Eigen::Vector3d::UnitX());
}

std::vector<Rotation> rotations() {
    const double pi = std::numbers::pi, third = pi / std::sqrt(3);
    return {// Rz(-30) Ry(-20) Rx(-170), computed alike by three independent robot programs.
            {"reference", zyx(-30, -20, -170), {-2.918909631, 0.734056335, -0.580708723}},
            {"straight_down", Eigen::Quaterniond(0, 1, 0, 0), {pi, 0, 0}},
            {"half_turn_about_y", Eigen::Quaterniond(0, 0, 1, 0), {0, pi, 0}},
            {"half_turn_about_a_diagonal", Eigen::Quaterniond(0, 1, 1, 1).normalized(), {third, third, third}},
            {"none", Eigen::Quaterniond::Identity(), {0, 0, 0}},
            {"gimbal_up", zyx(0, 90, 0), {0, 0.5 * pi, 0}},
            {"gimbal_down", zyx(0, -90, 0), {0, -0.5 * pi, 0}},
            {"tilt_of_a_fifth_of_a_degree", zyx(0, 0, 0.2), {0.2 * kDeg, 0, 0}},
            {"a_fifth_short_of_down", zyx(0, 0, 179.8), {179.8 * kDeg, 0, 0}}};
}

class Rotations : public testing::TestWithParam<Rotation> {};
INSTANTIATE_TEST_SUITE_P(Export, Rotations, testing::ValuesIn(rotations()),
                         [](const auto& tested) { return tested.param.name; });

TEST_P(Rotations, AbbQuaternion) {
    const Eigen::Quaterniond& q = GetParam().q;
    for (const double sign : {1.0, -1.0}) {
        const std::string text = program(test::plan_with(Eigen::Quaterniond(sign * q.coeffs())), "abb");
        const auto lines = lines_with(text, "[[");
        ASSERT_EQ(lines.size(), 4u);
        for (const std::string& line : lines) {
            const std::vector<double> n = numbers_in(line);
            const Eigen::Quaterniond written(n[3], n[4], n[5], n[6]);
            EXPECT_LT((written.coeffs() - sign * q.coeffs()).cwiseAbs().maxCoeff(), 5.1e-9) << "the sign is kept";
            EXPECT_NEAR(written.norm(), 1, 1e-8);
        }
    }
}

TEST_P(Rotations, UrRotationVector) {
    for (const double sign : {1.0, -1.0}) {
        const Eigen::Quaterniond q(sign * GetParam().q.coeffs());
        const std::string text = program(test::plan_with(q), "ur");
        const std::vector<double> n = numbers_in(lines_with(text, "movep").at(0));
        const Eigen::Vector3d vector(n[3], n[4], n[5]);
        const bool half_turn = std::abs(GetParam().vector.norm() - std::numbers::pi) < 1e-9;
        const double away = (vector - GetParam().vector).cwiseAbs().maxCoeff();
        const double opposite = (vector + GetParam().vector).cwiseAbs().maxCoeff();
        EXPECT_LT(half_turn ? std::min(away, opposite) : away, 5.1e-7);
    }
}

TEST_P(Rotations, CsvAndJsonQuaternion) {
    const Plan plan = test::plan_with(GetParam().q);
    const auto root = nlohmann::json::parse(program(plan, "json"));
    const auto rows = lines_with(program(plan, "csv"), ",weld_end,");
    ASSERT_EQ(rows.size(), 1u);
    std::vector<std::string> cells;
    std::istringstream row(rows[0]);
    for (std::string cell; std::getline(row, cell, ',');) {
        cells.push_back(cell);
    }
    const Eigen::Quaterniond& q = plan.waypoints[2].q;
    const std::vector<double> wxyz{q.w(), q.x(), q.y(), q.z()};
    const char* keys[] = {"qw", "qx", "qy", "qz"};
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(root["waypoints"][2][keys[i]].get<double>(), wxyz[i]);
        EXPECT_EQ(std::stod(cells.at(7 + i)), wxyz[i]);
    }
}

TEST(Export, ReferenceDigits) {
    const std::string text = program(test::plan_with(zyx(-30, -20, -170)), "abb");
    EXPECT_THAT(text, HasSubstr("[[25.123,10.568,-1.250],"));
    const std::vector<double> n = numbers_in(lines_with(text, "[[").at(1));
    const std::vector<double> published{0.038134576, -0.951548525, 0.239298338, -0.189307857};
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_NEAR(n[3 + i], published[i], 5.5e-9);
    }
}

// Out and back: the export itself reads its files again and throws where they say something else.
TEST(Export, FiveHundredRandomProgramsComeBackFromEveryRobot) {
    std::mt19937_64 generator(7);
    int seams = 0;
    for (int i = 0; i < 500; ++i) {
        const Plan plan = test::random_plan(generator);
        seams += plan.waypoints.back().seam + 1;
        ExportOptions options = i % 2 == 0 ? test::cell_options() : test::arc_options();
        options.robots = test::robots_without("linuxcnc");
        options.arc_moves = i % 4 < 2;
        options.kuka_spline = i % 3 == 0;
        for (const ProgramFile& file : export_programs(plan, options)) {
            const bool exact = file.robot == "csv" || file.robot == "json";
            const auto& format = *std::find_if(kRobotNames.begin(), kRobotNames.end(),
                                               [&](std::string_view name) { return name == file.robot; });
            const double rounding_mm =
                exporting::format(static_cast<std::size_t>(&format - kRobotNames.data())).position_rounding_mm;
            EXPECT_LE(file.max_position_error_mm, exact ? 0 : rounding_mm * std::sqrt(3) + 2e-9) << file.robot << i;
            EXPECT_LE(file.max_orientation_error_deg, exact                   ? 0
                                                      : file.robot == "fanuc" ? 9e-4
                                                                              : 1.3e-4)
                << file.robot << " " << i;
            EXPECT_LE(file.max_speed_error, 1e-3) << file.robot << " " << i;
            EXPECT_EQ(file.position_rounding_mm, rounding_mm);
        }
    }
    EXPECT_GE(seams, 500);
}

TEST(Export, RandomPlansComeBackFromLinuxcncOrAreRefused) {
    std::mt19937_64 generator(8);
    int seams = 0, refused = 0;
    for (int i = 0; i < 400; ++i) {
        const Plan plan = test::random_plan(generator);
        ExportOptions options = i % 2 ? test::arc_options() : test::cell_options();
        options.robots = "linuxcnc";
        try {
            const ProgramFile file = export_programs(plan, options).at(0);
            EXPECT_LE(file.max_orientation_error_deg, 2e-5);
            seams += plan.waypoints.back().seam + 1;
        } catch (const InputError& error) {
            EXPECT_THAT(error.what(), HasSubstr("straight up or down"));
            ++refused;
        }
    }
    EXPECT_GE(seams, 500) << refused << " refused";
}

TEST(Export, PlannedSeamsComeBack) {
    const std::vector<SeamModel> models{test::model_of(test::circle(40), true, 64),
                                        test::model_of(test::s_curve(200, 12), false, 120)};
    const Plan planned = plan(models, {});
    for (const ProgramFile& file : export_programs(planned, test::arc_options())) {
        EXPECT_LE(file.max_position_error_mm, 0.0009) << file.robot;
        EXPECT_LE(file.max_orientation_error_deg, file.robot == "fanuc" ? 9e-4 : 1e-4) << file.robot;
        EXPECT_LE(file.max_speed_error, 1e-9) << file.robot << ": 8 and 100 mm/s have few digits";
    }
}

TEST(Export, SameBytesEachTime) {
    ExportOptions options = test::arc_options();
    options.robots = test::robots_without("linuxcnc");
    const Plan plan = test::golden_plan();
    auto a = export_programs(plan, options), b = export_programs(plan, options);
    options.robots = "linuxcnc";
    for (auto* files : {&a, &b}) {
        files->push_back(export_programs(test::golden_plan_for("linuxcnc"), options).at(0));
    }
    std::vector<std::string_view> robots;
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_EQ(a[i].content, b[i].content);
        robots.emplace_back(a[i].robot);
        EXPECT_TRUE(a[i].file_name.ends_with(".mcap") ||
                    std::all_of(a[i].content.begin(), a[i].content.end(),
                                [](char c) { return c == '\n' || c == '\r' || c == '\t' || (c >= ' ' && c <= '~'); }))
            << "ASCII " << a[i].file_name;
    }
    robots.erase(std::unique(robots.begin(), robots.end()), robots.end());
    EXPECT_THAT(robots, testing::UnorderedElementsAreArray(kRobotNames));
}

TEST(Export, JsonIsJsonAndSaysItsUnits) {
    const Plan plan = test::golden_plan();
    const auto root = nlohmann::json::parse(program(plan, "json"));
    EXPECT_EQ(root["units"]["length"], "mm");
    EXPECT_EQ(root["units"]["speed"], "mm/s");
    EXPECT_EQ(root["frame"], "robot base");
    EXPECT_EQ(root["quaternion_order"], "qw,qx,qy,qz");
    EXPECT_EQ(root["duration_s"], plan.duration_s);
    ASSERT_EQ(root["waypoints"].size(), plan.waypoints.size());
    for (std::size_t k = 0; k < plan.waypoints.size(); ++k) {
        const auto& w = root["waypoints"][k];
        EXPECT_EQ(w["x"].get<double>(), plan.waypoints[k].p.x());
        EXPECT_EQ(w["time_s"].get<double>(), plan.waypoints[k].time_s);
        EXPECT_EQ(w["kind"], name(plan.waypoints[k].kind));
        EXPECT_EQ(w["seam"], plan.waypoints[k].seam);
        EXPECT_EQ(w["index"], plan.waypoints[k].index);
    }
}

TEST(Export, CsvSaysFrameUnitAndOrderFirst) {
    const std::string text = program(test::golden_plan(), "csv");
    const auto header = text.find("seam,index,kind,station_mm,x,y,z,qw,qx,qy,qz,speed_mm_s,time_s,sigma_mm\n");
    ASSERT_NE(header, std::string::npos);
    std::istringstream head(text.substr(0, header));
    for (std::string line; std::getline(head, line);) {
        EXPECT_EQ(line.front(), '#');
    }
    EXPECT_THAT(text.substr(0, header),
                AllOf(HasSubstr("Frame: robot base"), HasSubstr("mm/s"), HasSubstr("qw,qx,qy,qz")));
}

TEST(Export, PosesAreInTheBaseFrame) {
    ExportOptions options;
    options.base_from_scan = {1000, -200, 50, 0, 0, 0, 1};  // half a turn about Z
    const Plan plan = test::plan_with(Eigen::Quaterniond(0, 1, 0, 0));
    const auto w = nlohmann::json::parse(program(plan, "json", options))["waypoints"][1];
    EXPECT_NEAR(w["x"].get<double>(), 1000 - 25.1234, 1e-9);
    EXPECT_NEAR(w["y"].get<double>(), -200 - 10.5678, 1e-9);
    EXPECT_NEAR(w["z"].get<double>(), 48.75, 1e-9);
    const Eigen::Quaterniond q(w["qw"], w["qx"], w["qy"], w["qz"]);
    EXPECT_NEAR(rotation_angle(q, Eigen::Quaterniond(0, 0, 1, 0)), 0, 1e-9);
    EXPECT_THAT(program(plan, "abb", options), HasSubstr("[[974.877,-210.568,48.750],"));
    EXPECT_THAT(program(plan, "ur", options), HasSubstr("p[0.974877, -0.210568, 0.048750, "));
}

TEST(Export, AbbWeldsWithArcWare) {
    ExportOptions options = test::arc_options();
    options.abb_tool = "tTorch";
    options.abb_work_object = "wPart";
    options.abb_zone = "z5";
    const std::string text = program(test::golden_plan(), "abb", options);
    EXPECT_EQ(lines_with(text, "ArcLStart ").size(), 2u);
    EXPECT_EQ(lines_with(text, "ArcLEnd ").size(), 2u);
    EXPECT_EQ(lines_with(text, "ArcL ").size(), 6u);
    EXPECT_EQ(lines_with(text, "MoveJ ").size(), 1u);
    EXPECT_EQ(lines_with(text, "MoveL ").size(), 4u);
    for (const std::string& line : lines_with(text, "ArcL ")) {
        EXPECT_TRUE(line.ends_with(",seam1,weld1\\Weave:=weave1,z5,tTorch\\WObj:=wPart;")) << line;
    }
    for (const std::string& line : lines_with(text, "ArcLEnd ")) {
        EXPECT_TRUE(line.ends_with(",seam1,weld1\\Weave:=weave1,fine,tTorch\\WObj:=wPart;")) << line;
    }
    EXPECT_THAT(text, HasSubstr("speeddata speed1:=[8.5,500,5000,1000];"));
    EXPECT_THAT(text, Not(HasSubstr("%%%")));
    EXPECT_EQ(lines_with(text, "ConfL\\Off;").size(), 2u);
    EXPECT_THAT(text, AllOf(HasSubstr("PROC main()\n    seampath_seam0;\n    seampath_seam1;\n  ENDPROC"),
                            HasSubstr("[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]")));
}

TEST(Export, AbbMovesWithoutSeamAndWeldData) {
    const std::string text = program(test::golden_plan(), "abb");
    EXPECT_THAT(text, Not(HasSubstr("Arc")));
    EXPECT_EQ(lines_with(text, "MoveL ").size(), 14u);
}

TEST(Export, AbbQuaternionsKeepTheirSideAlongAWeld) {
    Plan plan = test::plan_with(Eigen::Quaterniond(0, 1, 0, 0));
    // A turn about X that leads w through zero: a canonical w >= 0 would jump.
    for (int k = 0; k < 4; ++k) {
        plan.waypoints[k].q = Eigen::AngleAxisd(std::numbers::pi + (k - 1.5) * 0.01, Eigen::Vector3d::UnitX());
    }
    const auto lines = lines_with(program(plan, "abb"), "[[");
    for (const std::string& line : lines) {
        EXPECT_GT(numbers_in(line)[4], 0.99) << line;
    }
}

Plan long_plan(int seams, int points) {
    return test::side_by_side(seams, points, [](int k) { return Eigen::Vector3d(k, 0, 0); });
}

TEST(Export, AbbSplitsLongProgramsBetweenSeams) {
    ExportOptions options = test::arc_options();
    options.robots = "abb";
    options.arc_moves = false;
    const auto files = export_programs(long_plan(3, 2000), options);
    std::vector<std::string> names;
    for (const ProgramFile& file : files) {
        names.push_back(file.file_name);
        EXPECT_LE(std::count(file.content.begin(), file.content.end(), '\n'), 5000);
        EXPECT_EQ(lines_with(file.content, "ArcLStart").size(), lines_with(file.content, "ArcLEnd").size());
    }
    EXPECT_THAT(names, ElementsAre("seampath.mod", "seampath_mod0.mod", "seampath_mod1.mod", "seampath_mod2.mod"));
    EXPECT_THAT(files[0].content, HasSubstr("seampath_seam2;"));
    EXPECT_EQ(export_programs(long_plan(2, 2000), options).size(), 1u) << "5000 lines hold these";
}

TEST(Export, AbbRefusesASeamOfTooManyLines) {
    ExportOptions options;
    options.robots = "abb";
    options.arc_moves = false;
    EXPECT_THAT(
        [&] { export_programs(long_plan(2, 5000), options); },
        ThrowsMessage<InputError>(AllOf(HasSubstr("export: abb: seam 0 makes"), HasSubstr("chord_tolerance_mm"))));
}

TEST(Export, UrWeldsWithAnOutputAndBlendsThatCannotOverlap) {
    const std::string text = program(test::golden_plan(), "ur", test::arc_options());
    EXPECT_THAT(text, AllOf(testing::StartsWith("def seampath():\n"), testing::EndsWith("\nend\n")));
    EXPECT_EQ(lines_with(text, "set_standard_digital_out(3, True)").size(), 2u);
    EXPECT_EQ(lines_with(text, "set_standard_digital_out(3, False)").size(), 3u) << "off first, then after each seam";
    EXPECT_EQ(lines_with(text, "movep(").size(), 8u);
    EXPECT_EQ(lines_with(text, ", r=0.001000)").size(), 6u);
    EXPECT_THAT(text, HasSubstr("v=0.008500)"));
    ExportOptions straight;
    straight.arc_moves = false;
    const std::string close = program(long_plan(1, 6), "ur", straight);
    EXPECT_EQ(lines_with(close, ", r=0.000400)").size(), 4u) << "0.4 of moves of 1 mm";
}

TEST(Export, UrStopsWhereMovesAreTooShortToBlend) {
    Plan plan = long_plan(1, 6);
    plan.waypoints[3].p = plan.waypoints[2].p + Eigen::Vector3d(0.02, 0, 0);
    ExportOptions options;
    options.arc_moves = false;
    EXPECT_EQ(lines_with(program(plan, "ur", options), ", r=0.000000)").size(), 2u);
}

TEST(Export, UrTcpIsInMetres) {
    ExportOptions options;
    options.ur_tcp = {0, -12.5, 380, 0, 0.5, 0};
    EXPECT_THAT(program(test::golden_plan(), "ur", options),
                HasSubstr("set_tcp(p[0.000000, -0.012500, 0.380000, 0.000000, 0.500000, 0.000000])"));
}

TEST(Export, SlowSpeedsKeepTheirDigits) {
    EXPECT_THAT(program(test::plan_with(zyx(0, 0, 180), 8.5), "ur"), HasSubstr("v=0.008500"));
    ExportOptions options;
    options.robots = "ur";
    EXPECT_THAT([&] { export_programs(test::plan_with(zyx(0, 0, 180), 0.05), options); },
                ThrowsMessage<InputError>(AllOf(HasSubstr("export: ur: waypoint 2 of seam 0 has a speed of 0.05 mm/s"),
                                                HasSubstr("at least 0.1 mm/s"))));
}

TEST(Export, RefusesPositionsThatAFormatCannotHold) {
    ExportOptions options;
    options.base_from_scan[0] = 9000;
    options.robots = "abb";
    EXPECT_THAT(
        [&] { export_programs(test::golden_plan(), options); },
        ThrowsMessage<InputError>(AllOf(HasSubstr("abb"), HasSubstr("8388.607 mm"), HasSubstr("base_from_scan"))));
    options.robots = "csv,json,ur";
    EXPECT_EQ(export_programs(test::golden_plan(), options).size(), 3u);
    options.base_from_scan[0] = -11000;
    options.robots = "ur";
    EXPECT_THROW(export_programs(test::golden_plan(), options), InputError);
}

TEST(Export, RefusesAnEmptyPlan) {
    EXPECT_THAT([] { export_programs({}, {}); }, ThrowsMessage<InputError>(HasSubstr("0 waypoints")));
}

TEST(Export, UnknownRobotListsThoseThereAre) {
    ExportOptions options;
    options.robots = "csv, kuba,csv";
    EXPECT_THAT([&] { export_programs(test::golden_plan(), options); },
                ThrowsMessage<InputError>(
                    AllOf(HasSubstr("\"kuba\""), HasSubstr("csv, json, abb, kuka, fanuc, ur"), HasSubstr("twice"))));
    options.robots = "";
    EXPECT_THAT(export_problems(options), Contains(HasSubstr("robots: \"\" is no known robot")));
    options.robots = "ur, csv";
    const auto files = export_programs(test::golden_plan(), options);
    ASSERT_EQ(files.size(), 2u);
    EXPECT_EQ(files[0].robot, "ur");
    EXPECT_EQ(files[0].file_name, "seampath.script");
    EXPECT_EQ(files[1].file_name, "waypoints.csv");
}

struct Bad {
    std::string problem;
    std::function<void(ExportOptions&)> make;
};

TEST(Export, NamesAndPosesAreChecked) {
    const std::vector<Bad> all{
        {"program_name: \"2nd\" is no name in RAPID", [](auto& o) { o.program_name = "2nd"; }},
        {"program_name: \"\" is no name in URScript", [](auto& o) { o.program_name = ""; }},
        {"program_name: \"weld-1\" is no name", [](auto& o) { o.program_name = "weld-1"; }},
        {"program_name: \"../x\" is no name", [](auto& o) { o.program_name = "../x"; }},
        {"program_name: \"MoveL\" is a word of RAPID", [](auto& o) { o.program_name = "MoveL"; }},
        {"program_name: \"Main\" is a word of RAPID", [](auto& o) { o.program_name = "Main"; }},
        {"program_name: \"thread\" is a word of URScript", [](auto& o) { o.program_name = "thread"; }},
        {"has 25 characters; at most 24", [](auto& o) { o.program_name = std::string(25, 'a'); }},
        {"abb_tool: \"t one\" is no name in RAPID", [](auto& o) { o.abb_tool = "t one"; }},
        {"abb_work_object: \"PERS\" is a word", [](auto& o) { o.abb_work_object = "PERS"; }},
        {"abb_zone: \"" + std::string(33, 'z'), [](auto& o) { o.abb_zone = std::string(33, 'z'); }},
        {"both were needed", [](auto& o) { o.abb_seam_data = "seam1"; }},
        {"abb_weld_data: \"w;\"",
         [](auto& o) {
             o.abb_seam_data = "seam1";
             o.abb_weld_data = "w;";
         }},
        {"ur_tcp: [0, 0]",
         [](auto& o) {
             o.ur_tcp = {0, 0};
         }},
        {"ur_arc_output: 1.5", [](auto& o) { o.ur_arc_output = 1.5; }},
        {"ur_arc_output: 8", [](auto& o) { o.ur_arc_output = 8; }},
        {"quaternion qw, qx, qy, qz of length 1", [](auto& o) { o.base_from_scan[3] = 1.1; }},
        {"base_from_scan: [1, 2]",
         [](auto& o) {
             o.base_from_scan = {1, 2};
         }},
        {"base_from_scan: [nan", [](auto& o) { o.base_from_scan[0] = std::nan(""); }},
    };
    for (const Bad& bad : all) {
        ExportOptions options;
        bad.make(options);
        EXPECT_THAT(export_problems(options), Contains(HasSubstr(bad.problem)));
        EXPECT_THROW(export_programs(test::golden_plan(), options), InputError) << bad.problem;
    }
    EXPECT_THAT(export_problems({}), IsEmpty());
    ExportOptions csv_only;
    csv_only.robots = "csv";
    csv_only.abb_tool = "t one";
    EXPECT_THAT(export_problems(csv_only), IsEmpty()) << "a robot that is not asked for has no say";
}

TEST(Export, OptionsAreListedOnce) {
    ExportOptions options;
    std::vector<std::string> keys;
    for (const Field& field : describe(options)) {
        keys.emplace_back(field.key);
        EXPECT_FALSE(field.meaning.empty());
    }
    EXPECT_GT(keys.size(), 30u);
    std::sort(keys.begin(), keys.end());
    EXPECT_EQ(std::adjacent_find(keys.begin(), keys.end()), keys.end());
}

}  // namespace export_test
}  // namespace seampath
