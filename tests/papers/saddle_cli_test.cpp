#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "stages/text.hpp"
#include "tests/cli/spawn.hpp"
#include "tests/papers/tables.hpp"

namespace seampath {
namespace {

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

}  // namespace
}  // namespace seampath
