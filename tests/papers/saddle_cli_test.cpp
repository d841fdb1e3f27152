#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "stages/text.hpp"
#include "tests/cli/spawn.hpp"
#include "tests/papers/tables.hpp"

namespace seampath {
namespace saddle_cli_test {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using Words = std::vector<std::string>;

Outcome saddle_program(const fs::path& out, const Words& more) {
    Words words{"saddle", "--out", out};
    words.insert(words.end(), more.begin(), more.end());
    return seampath_program(words);
}

const Words kPaper{"--header-radius-mm", "600", "--branch-radius-mm", "150"};

Words paper_and(const Words& more) {
    Words words = kPaper;
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

TEST(SaddleCli, PointsOfEqualAnglesAreThePapersTable) {
    const TestFolder out;
    const Outcome run = saddle_program(out.path(), paper_and({"--step", "equal-angle", "--pose", "paper"}));
    ASSERT_EQ(run.status, 0) << run.err;
    EXPECT_THAT(run.out, AllOf(HasSubstr("946.2677 mm"), HasSubstr("90.00 to 104.48 deg")));
    const auto printed = read_table(paper_file("xue_table_1.csv")).rows;
    const Table points = read_table(out.path() / "saddle_points.csv");
    EXPECT_THAT(points.header, testing::Contains("opening_deg"));
    ASSERT_EQ(points.rows.size(), printed.size());
    for (std::size_t k = 0; k < printed.size(); ++k) {
        const auto& row = points.rows[k];
        const double degree = std::numbers::pi / 180;
        const std::vector<double> values{row[1] * degree, row[4], row[5], row[6], row[7] * degree};
        for (std::size_t column = 0; column < values.size(); ++column) {
            EXPECT_EQ(fixed(values[column], 4), fixed(printed[k][column], 4)) << "row " << k << " column " << column;
        }
    }
}

TEST(SaddleCli, LeavesTheFilesOfARunButThoseOfAScan) {
    const TestFolder out, again;
    ASSERT_EQ(saddle_program(out.path(), kPaper).status, 0);
    const auto files = contents(out.path());
    for (const auto* name :
         {"waypoints.csv", "seams.json", "report.json", "report.html", "config.resolved.json", "saddle_points.csv",
          "saddle.json", "programs/abb/seampath.mod", "programs/ur/seampath.script", "programs/csv/manifest.json"}) {
        EXPECT_TRUE(files.contains(name)) << name;
    }
    EXPECT_FALSE(files.contains("seam_points.csv"));
    EXPECT_FALSE(holds_temporary_files(out.path()));
    EXPECT_THAT(files.at("waypoints.csv"), AllOf(HasSubstr("# frame: nominal"), HasSubstr("nominal_from_tool")));

    const json seams = json::parse(files.at("seams.json"));
    EXPECT_EQ(seams.at("frame"), "nominal");
    EXPECT_EQ(seams.at("seams")[0].at("kind"), "saddle");
    EXPECT_NEAR(seams.at("seams")[0].at("length_mm").get<double>(), 946.2677, 5e-5);
    EXPECT_LE(seams.at("seams")[0].at("model").at("residual_max_mm").get<double>(), 1e-7);
    EXPECT_FALSE(seams.at("seams")[0].contains("deviation"));

    const json report = json::parse(files.at("report.json"));
    EXPECT_TRUE(report.at("scan").is_null());
    EXPECT_EQ(report.at("verdict"), "pass");
    EXPECT_THAT(report.at("sentence").get<std::string>(), HasSubstr("not compared with a scan"));
    const std::string& page = files.at("report.html");
    EXPECT_NE(page.find("nominal, not checked against a scan"), std::string::npos);
    for (const auto* scans : {"Deviation from the scan", "data-layer=\"scan\"", "<h2>Scan</h2>", "Checked"}) {
        EXPECT_EQ(page.find(scans), std::string::npos) << scans;
    }

    ASSERT_EQ(saddle_program(again.path(), kPaper).status, 0);
    expect_same_files(out.path(), again.path());
}

TEST(SaddleCli, ProductsOfAnEarlierScanDoNotStayBeside) {
    const TestFolder out;
    ASSERT_EQ(seampath_program(run_small_tee(out.path())).status, 0);
    EXPECT_TRUE(fs::exists(out.path() / "seam_points.csv"));
    ASSERT_EQ(saddle_program(out.path(), paper_and({"--robot", "ur"})).status, 0);
    EXPECT_FALSE(fs::exists(out.path() / "seam_points.csv"));
    EXPECT_FALSE(fs::exists(out.path() / "programs" / "abb"));
    EXPECT_TRUE(fs::exists(out.path() / "programs" / "ur"));
    // The torch can't stand in so narrow an opening: nothing of the run before may look like its result.
    EXPECT_EQ(saddle_program(out.path(), paper_and({"--angle-deg", "2"})).status, 2);
    for (const auto* name : {"saddle_points.csv", "saddle.json", "waypoints.csv", "report.json"}) {
        EXPECT_FALSE(fs::exists(out.path() / name)) << name;
    }
}

TEST(SaddleCli, PeriodAndSpeedGivePointsAtEqualTimes) {
    const TestFolder out;
    const Outcome run = saddle_program(out.path(), paper_and({"--angle-deg", "60", "--offset-mm", "80", "--speed-mm-s",
                                                              "8", "--period-s", "0.25", "--robot", "csv", "--json"}));
    ASSERT_EQ(run.status, 0) << run.err;
    const json facts = json::parse(run.out);
    EXPECT_EQ(run.out, text_of(out.path() / "saddle.json"));
    EXPECT_NEAR(facts.at("length_mm").get<double>(), 1026.2496, 5e-5);
    EXPECT_EQ(facts.at("dimensions").at("angle_deg"), 60);
    EXPECT_EQ(facts.at("dimensions").at("header_radius_mm"), 600);
    EXPECT_FALSE(facts.at("dimensions").contains("head_depth_mm"));
    EXPECT_EQ(facts.at("step_mm"), 2.0);
    EXPECT_EQ(facts.at("steps"), 514);
    EXPECT_LT(facts.at("speed_error_arc_percent").get<double>(), 1e-10);
    const auto rows = read_table(out.path() / "saddle_points.csv").rows;
    for (std::size_t k = 1; k + 1 < rows.size(); ++k) {
        EXPECT_NEAR(rows[k][2], 2.0 * static_cast<double>(k), 1e-9);
        EXPECT_NEAR(rows[k][3], 0.25 * static_cast<double>(k), 1e-12);
    }
    EXPECT_NEAR(rows.back()[3], 1026.249577 / 8, 1e-6);
    const auto waypoints = text_of(out.path() / "waypoints.csv");
    EXPECT_THAT(waypoints, HasSubstr(",8,"));
    EXPECT_FALSE(fs::exists(out.path() / "programs" / "abb"));
}

TEST(SaddleCli, EveryHeaderGivesPrograms) {
    for (const Words& words :
         {Words{"--header", "plane", "--branch-radius-mm", "40", "--angle-deg", "50"},
          Words{"--header", "cone", "--header-radius-mm", "200", "--cone-half-angle-deg", "20", "--branch-radius-mm",
                "50"},
          Words{"--header", "sphere", "--header-radius-mm", "250", "--branch-radius-mm", "50", "--offset-mm", "120"},
          Words{"--header", "ellipsoid", "--header-radius-mm", "400", "--head-depth-mm", "200", "--branch-radius-mm",
                "45", "--offset-mm", "150", "--angle-deg", "80"}}) {
        const TestFolder out;
        const Outcome run = saddle_program(out.path(), words);
        EXPECT_EQ(run.status, 0) << run.err;
        EXPECT_TRUE(fs::exists(out.path() / "programs" / "abb" / "seampath.mod"));
    }
}

TEST(SaddleCli, WeldsInThePassesThatFillAGroove) {
    const TestFolder out;
    const Outcome run = saddle_program(
        out.path(), paper_and({"--groove", "fillet", "--groove-depth-mm", "8", "--bead-area-mm2", "20", "--json"}));
    ASSERT_EQ(run.status, 0) << run.err;
    const json passes = json::parse(run.out).at("passes");
    ASSERT_EQ(passes.size(), 4u);
    // Mean of h^2 tan(psi / 2) round the seam, psi = 90 + asin(sin^2 / 4) deg.
    double sum = 0, mean = 0;
    for (const json& pass : passes) {
        sum += pass.at("area_mm2").get<double>();
    }
    for (int k = 0; k < 3600; ++k) {
        const double sine = std::sin(2 * std::numbers::pi * k / 3600);
        mean += 64 * std::tan(0.5 * (std::numbers::pi / 2 + std::asin(0.25 * sine * sine))) / 3600;
    }
    EXPECT_NEAR(sum, mean, 2e-3 * mean) << "stations are nearly in step with the branch angle";
    const Table table = read_table(out.path() / "passes.csv");
    ASSERT_EQ(table.rows.size(), 4u);
    EXPECT_NEAR(table.rows[3][6], passes[3].at("tilt_deg").get<double>(), 1e-9);
    const std::string waypoints = text_of(out.path() / "waypoints.csv");
    std::size_t starts = 0;
    for (auto at = waypoints.find(",weld_start,"); at != std::string::npos;
         at = waypoints.find(",weld_start,", at + 1)) {
        ++starts;
    }
    EXPECT_EQ(starts, 4u);
    EXPECT_THAT(text_of(out.path() / "report.json"), HasSubstr("\"name\": \"passes\""));
    const Outcome paper = saddle_program(out.path(), paper_and({"--groove", "fillet", "--pose", "paper"}));
    EXPECT_EQ(paper.status, 2);
    EXPECT_THAT(paper.err, HasSubstr("--pose: the paper's law knows one pass"));
    // One pass leaves no table of several.
    ASSERT_EQ(saddle_program(out.path(), paper_and({"--robot", "csv"})).status, 0);
    EXPECT_FALSE(fs::exists(out.path() / "passes.csv"));
}

const Words kPipes{"--header-radius-mm",
                   "200",
                   "--branch-radius-mm",
                   "60",
                   "--set",
                   "plan.flange_from_tool=[40, 0, 300, 0.95371695, 0, 0.30070580, 0]"};

Outcome pipes_with_arm(const fs::path& out, const std::string& arm, const std::string& place, Words more = {}) {
    Words words = kPipes;
    words.insert(words.end(), {"--set", "plan.arm=" + arm, "--set", "export.base_from_scan=" + place});
    words.insert(words.end(), more.begin(), more.end());
    return saddle_program(out, words);
}

TEST(SaddleCli, TakesTheTravelThroughAnArm) {
    const TestFolder out, other;
    const std::string place = "[850, 0, 0, 1, 0, 0, 0]";
    const Outcome run = pipes_with_arm(out.path(), "abb-irb-1600-8-1.45", place);
    ASSERT_EQ(run.status, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("IRB 1600-8/1.45 makes the travel"));
    std::size_t rows = 0;
    const std::string joints = text_of(out.path() / "joints.csv");
    for (const char c : joints) {
        rows += c == '\n' ? 1 : 0;
    }
    EXPECT_GT(rows, 100u);
    EXPECT_THAT(joints, AllOf(HasSubstr("# arm: IRB 1600-8/1.45"), HasSubstr(",j1_deg,j2_deg,"),
                              HasSubstr("\n0,weld_start,1,")));
    const std::string page = text_of(out.path() / "report.html");
    for (const auto* seen : {"<h2>Robot arm</h2>", "<b>Axis 6</b>", "<b>Manipulability</b>", "arm_limit_margin_deg"}) {
        EXPECT_NE(page.find(seen), std::string::npos) << seen;
    }
    // The same arm from its file.
    const std::string urdf = std::string(SEAMPATH_SOURCE_DIR) + "/pipeline/arms/abb-irb-1600-8-1.45.urdf";
    ASSERT_EQ(pipes_with_arm(other.path(), urdf, place).status, 0);
    EXPECT_EQ(text_of(other.path() / "joints.csv"), joints);
}

TEST(SaddleCli, AnArmThatCannotReachGetsNoProgram) {
    const TestFolder out;
    const Outcome run = pipes_with_arm(out.path(), "ur10e", "[2000, 0, 0, 1, 0, 0, 0]");
    EXPECT_EQ(run.status, 1) << run.err;
    EXPECT_THAT(run.out, AllOf(HasSubstr("UR10e can't make seam 0: at approach"), HasSubstr("part moved by"),
                               HasSubstr("none: the arm can't make it")));
    EXPECT_FALSE(fs::exists(out.path() / "joints.csv"));
    EXPECT_FALSE(fs::exists(out.path() / "programs"));
    const json report = json::parse(text_of(out.path() / "report.json"));
    EXPECT_EQ(report.at("verdict"), "fail");
    EXPECT_THAT(report.at("sentence").get<std::string>(), HasSubstr("can't make seam 0"));
    const std::vector<std::pair<Words, std::string>> cases{
        {{"--set", "plan.arm=ur10"}, "did you mean \"ur10e\"?"},
        {{"--set", "plan.flange_from_tool=[0, 0, 0, 2, 0, 0, 0]"}, "--set: /plan/flange_from_tool: the quaternion"},
        {{"--set", "plan.arm_acceleration_deg_s2=[1, 2]"}, "/plan/arm_acceleration_deg_s2"},
        {{"--set", "plan.arm=" + std::string(SEAMPATH_SOURCE_DIR) + "/README.md"}, "README.md:"}};
    for (const auto& [more, message] : cases) {
        const Outcome wrong = pipes_with_arm(out.path(), "ur10e", "[700, 0, 0, 1, 0, 0, 0]", more);
        EXPECT_EQ(wrong.status, 2) << message;
        EXPECT_THAT(wrong.err, HasSubstr(message));
    }
}

TEST(SaddleCli, SaysWhatCannotBeAndLeavesNothing) {
    const std::vector<std::pair<Words, std::string>> cases{
        {{"--header-radius-mm", "150", "--branch-radius-mm", "160"}, "partial penetration"},
        {{"--header-radius-mm", "150", "--branch-radius-mm", "150"}, "only touches the header"},
        {paper_and({"--angle-deg", "180"}), "is 180 deg; an angle between 0 and 180 deg is needed"},
        {paper_and({"--header", "plane"}), "--header-radius-mm: the header \"plane\" has no such size"},
        {{"--branch-radius-mm", "150"}, "--header-radius-mm: the header \"cylinder\" needs it"},
        {paper_and({"--header", "cone"}), "--cone-half-angle-deg: the header \"cone\" needs it"},
        {paper_and({"--header", "cone", "--cone-half-angle-deg", "95"}), "half angle is 95.00 deg"},
        {paper_and({"--header", "spere"}), "did you mean \"sphere\"?"},
        {paper_and({"--step", "equal"}), "there are equal-angle, variable-angle, arc-length"},
        {paper_and({"--pose", "bisecter"}), "did you mean \"bisector\"?"},
        {paper_and({"--period-s", "0"}), "--period-s: 0 is no period"},
        {paper_and({"--period-s", "1e-9"}), "more than 10 million"},
        {paper_and({"--steps", "0"}), "--steps: 0 is too few"},
        {paper_and({"--pose", "paper", "--pose-angle-deg", "nan"}), "--pose-angle-deg: nan deg points into"},
        {paper_and({"--pose", "paper", "--pose-angle-deg", "180"}), "--pose-angle-deg: 180 deg points into"},
        {paper_and({"--speed-mm-s", "-1"}), "--speed-mm-s: /plan/speed_mm_s: -1"},
        {paper_and({"--robot", "abc"}), "abc"}};
    for (const auto& [words, message] : cases) {
        const TestFolder out;
        const Outcome run = saddle_program(out.path() / "new", words);
        EXPECT_EQ(run.status, 2) << message;
        EXPECT_THAT(run.err, HasSubstr(message));
        EXPECT_EQ(run.out, "") << message;
        EXPECT_FALSE(fs::exists(out.path() / "new" / "waypoints.csv")) << message;
    }
}

}  // namespace saddle_cli_test
}  // namespace seampath
