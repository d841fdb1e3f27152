#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "stages/geometry/piecewise_cubic.hpp"
#include "tests/cli/spawn.hpp"
#include "tests/papers/tables.hpp"

namespace seampath {
namespace parametrize_cli_test {

using testing::AllOf;
using testing::HasSubstr;
using Words = std::vector<std::string>;

Outcome parametrize_program(Words more) {
    more.insert(more.begin(), "parametrize");
    return seampath_program(more);
}

TEST(ParametrizeCli, JsonHoldsThePapersFigures) {
    const Outcome run = parametrize_program(
        {paper_file("marin_table_4.csv"), "--objective", "diagonal", "--weights", "1,1,2,6,6,6", "--json"});
    ASSERT_EQ(run.status, 0) << run.err;
    const auto json = nlohmann::json::parse(run.out);
    EXPECT_EQ(json.at("t").size(), 21u);
    EXPECT_NEAR(json.at("diagonal_energy").get<double>(), 6414.5394, 5e-5);
    EXPECT_NEAR(json.at("max_acceleration")[3].get<double>(), 505, 0.7);
    EXPECT_NEAR(json.at("travel_time").get<double>(), 11.71, 5e-3);
    EXPECT_NEAR(json.at("chord").at("peak").get<double>(), 312.67, 5e-3);
    EXPECT_LE(json.at("evaluations").get<int>(), 40);
    EXPECT_EQ(json.at("converged"), true);
}

TEST(ParametrizeCli, LimitsAndWeightsAreTwoThings) {
    const auto peak = [](const Words& more) {
        Words words{paper_file("marin_table_4.csv"), "--json"};
        words.insert(words.end(), more.begin(), more.end());
        return nlohmann::json::parse(parametrize_program(words).out).at("peak").get<double>();
    };
    EXPECT_NEAR(peak({"--objective", "minimax", "--limits", "1,1,2,6,6,6"}), 80.252, 1e-3);
    EXPECT_NEAR(peak({"--objective", "minimax", "--weights", "1,1,2,6,6,6"}), 80.252, 1e-3);
    EXPECT_NEAR(peak({"--limits", "1,1,2,6,6,12"}), 312.666, 1e-3);
}

TEST(ParametrizeCli, WritesThePointsWithTheirParameters) {
    const TestFolder folder;
    const auto file = folder.path() / "new" / "t.csv";
    const Outcome run = parametrize_program({paper_file("marin_table_2.csv"), "--objective", "exact", "--out", file});
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_THAT(run.out, AllOf(HasSubstr("173.5115"), HasSubstr("247.9026"), HasSubstr("29.8 %")));
    const Table table = read_table(file);
    EXPECT_THAT(table.header, testing::ElementsAre("t", "x", "y"));
    ASSERT_EQ(table.rows.size(), 20u);
    EXPECT_THAT(table.rows.front(), testing::ElementsAre(0, 0.53, 0.72));
    EXPECT_THAT(table.rows.back(), testing::ElementsAre(1, 0.09, 0.385));
}

// At the times that come out, by differences of the spline through the table: no axis exceeds its limit, one reaches
// it.
TEST(ParametrizeCli, TimesHoldTheLimitsOfEachAxis) {
    const TestFolder folder;
    const auto file = folder.path() / "timed.csv";
    const std::vector<double> limits{1, 1, 2, 6, 6, 12};
    const Outcome run = parametrize_program({paper_file("marin_table_4.csv"), "--objective", "minimax", "--limits",
                                             "1,1,2,6,6,12", "--out", file, "--json"});
    ASSERT_EQ(run.status, 0) << run.err;
    const auto json = nlohmann::json::parse(run.out);
    const Table table = read_table(file);
    ASSERT_EQ(table.header.size(), 8u);
    EXPECT_THAT(table.header, testing::Contains("time_s"));
    std::vector<double> time;
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
        time.push_back(table.rows[i][1]);
        EXPECT_EQ(json.at("time_s")[i].get<double>(), time.back());
        EXPECT_NEAR(time.back(), table.rows[i][0] * json.at("travel_time").get<double>(), 1e-12);
    }
    double most = 0;
    for (std::size_t axis = 0; axis < 6; ++axis) {
        std::vector<double> angle;
        for (const auto& row : table.rows) {
            angle.push_back(row[axis + 2]);
        }
        const PiecewiseCubic spline = natural_spline(time, angle);
        double largest = 0;
        for (const double at : time) {  // linear in between
            largest = std::max(largest, std::abs(spline.second(at)));
        }
        EXPECT_NEAR(json.at("acceleration_over_limit")[axis].get<double>(), largest / limits[axis], 1e-9);
        most = std::max(most, largest / limits[axis]);
    }
    EXPECT_NEAR(most, 1, 1e-9);
    EXPECT_THAT(parametrize_program({paper_file("marin_table_4.csv"), "--limits", "1,1,2,6,6,12"}).out,
                AllOf(HasSubstr("time s"), HasSubstr("over limit"), HasSubstr("17.68")));
}

TEST(ParametrizeCli, RefusesRepeatedPointsWithRowsAndLines) {
    const TestFolder folder;
    const std::string file = folder.path() / "points.csv";
    std::ofstream(file) << "# twice\nx,y\n0,0\n1,2\n1,2\n3,3\n";
    const Outcome run = parametrize_program({file});
    EXPECT_EQ(run.status, 2);
    EXPECT_EQ(run.out, "");
    EXPECT_THAT(run.err, HasSubstr(file + ": rows 2 and 3 (lines 4 and 5) are the same point"));
}

TEST(ParametrizeCli, SaysWhatIsWrongWithTheOptions) {
    const std::string file = paper_file("marin_table_2.csv");
    const std::vector<std::pair<Words, std::string>> cases{
        {{file, "--objective", "exat"}, "did you mean \"exact\"?"},
        {{file, "--solver", "bfgs"}, "did you mean \"lbfgs\"?"},
        {{file, "--solver", "gradient-projection"}, "is for the objectives exact and diagonal, not for chord"},
        {{file, "--weights", "1,x"}, "--weights"},
        {{file, "--weights", "1"}, "1 weights for points of 2 coordinates"},
        {{file, "--limits", "1,-1"}, "limits: -1 is not above 0"},
        {{file, "--out", "/"}, "is no file name"},
        {{"none.csv"}, "there is no file none.csv"},
        {{}, "POINTS is required"}};
    for (const auto& [words, message] : cases) {
        const Outcome run = parametrize_program(words);
        EXPECT_EQ(run.status, 2) << message;
        EXPECT_THAT(run.err, HasSubstr(message));
        EXPECT_EQ(run.out, "") << message;
    }
}

}  // namespace parametrize_cli_test
}  // namespace seampath
