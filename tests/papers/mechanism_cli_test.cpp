#include <chrono>
#include <cmath>
#include <fstream>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "stages/geometry/sampled_spline.hpp"
#include "tests/cli/spawn.hpp"
#include "tests/papers/tables.hpp"
#include "tests/papers/written_run.hpp"

namespace seampath {
namespace mechanism_cli_test {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using Words = std::vector<std::string>;

Outcome two_tier_program(const Words& more) {
    Words words{"mechanism", "two-tier"};
    words.insert(words.end(), more.begin(), more.end());
    return seampath_program(words);
}

const Words kPaperLine{"--from", "-350,-100", "--to", "160,280"};

Words paper_and(const Words& more) {
    Words words = kPaperLine;
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

TEST(MechanismCli, PrintsThePapersFiguresForBothSetsOfNodes) {
    EXPECT_THAT(two_tier_program(kPaperLine).out,
                AllOf(HasSubstr("19 nodes, 18 beats"), HasSubstr("9.914037"), HasSubstr("24.6912")));
    const Outcome run = two_tier_program(paper_and({"--method", "bresenham", "--json"}));
    ASSERT_EQ(run.status, 0) << run.err;
    const json result = json::parse(run.out);
    EXPECT_EQ(result.at("nodes"), 26);
    EXPECT_NEAR(result.at("after_first").at("rms_mm").get<double>(), 15.799855, 5e-7);
    EXPECT_NEAR(result.at("interior").at("rms_mm").get<double>(), 16.072478, 5e-7);
}

TEST(MechanismCli, TableHalvesDownToTheStepThatIsAsked) {
    const Outcome run = two_tier_program(paper_and({"--table", "0.01", "--json"}));
    ASSERT_EQ(run.status, 0) << run.err;
    const json series = json::parse(run.out).at("series");
    ASSERT_EQ(series.size(), 10u);
    EXPECT_EQ(series.back().at("beta_step_deg"), 5.0 / 512);
    EXPECT_EQ(series.back().at("nodes"), 8664);
    EXPECT_LT(series.back().at("interior").at("rms_mm").get<double>(), 0.03);
}

TEST(MechanismCli, WritesStepsADrawingAndTheResult) {
    const TestFolder out;
    const Outcome run = two_tier_program(paper_and({"--out", out.path(), "--method", "optimal", "--json"}));
    ASSERT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(run.out, text_of(out.path() / "mechanism.json"));
    const Table steps = read_table(out.path() / "steps.csv");
    EXPECT_THAT(steps.header,
                testing::ElementsAre("index", "alpha_steps", "beta_steps", "alpha_deg", "beta_deg", "x", "y"));
    ASSERT_EQ(steps.rows.size(), 19u);
    double alpha = steps.rows[0][3], beta = steps.rows[0][4];
    for (std::size_t k = 1; k < steps.rows.size(); ++k) {
        alpha += 10 * steps.rows[k][1];
        beta += 5 * steps.rows[k][2];
        EXPECT_NEAR(std::remainder(alpha - steps.rows[k][3], 360), 0, 1e-9);
        EXPECT_NEAR(beta, steps.rows[k][4], 1e-9);
        const double radius = 1000 * std::sin(beta / 2 * std::numbers::pi / 180);
        EXPECT_NEAR(std::hypot(steps.rows[k][5], steps.rows[k][6]), radius, 1e-9);
    }
    const std::string svg = text_of(out.path() / "grid.svg");
    EXPECT_TRUE(svg.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plot\""));
    EXPECT_TRUE(svg.ends_with("</svg>\n"));
    EXPECT_THAT(svg, AllOf(HasSubstr("<style>"), HasSubstr("class=\"wanted\""), HasSubstr("class=\"way\"")));
}

TEST(MechanismCli, FollowsAPolylineProjectedToItsPlane) {
    const TestFolder folder;
    const std::string file = folder.path() / "path.csv";
    std::ofstream(file) << "index,x_mm,y_mm,z_mm\n0,100,0,5\n1,0,100,7\n2,-100,0,9\n3,0,-100,7\n";
    const Outcome run =
        two_tier_program({"--path", file, "--alpha-step-deg", "0.5", "--beta-step-deg", "0.25", "--json"});
    ASSERT_EQ(run.status, 0) << run.err;
    const json result = json::parse(run.out);
    EXPECT_LT(result.at("all").at("max_mm").get<double>(), 3);
    EXPECT_LT(result.at("end_gap_mm").get<double>(), 3);
    EXPECT_GT(result.at("nodes").get<int>(), 100);
}

// A ring of 60 mm, which the run's base sees tilted by 60 deg: an ellipse of 60 by 30 mm.
TEST(MechanismCli, FollowsTheSeamOfARunProjectedToItsPlane) {
    const TestFolder folder;
    SeamModel ring;
    ring.closed = true;
    ring.curve =
        spline_through([](double s) { return Eigen::Vector3d(60 * std::cos(s / 60), 60 * std::sin(s / 60), 0); },
                       120 * std::numbers::pi, true, 1e-7)
            .curve;
    Config config;
    config.export_.base_from_scan = {100, -50, 7, std::cos(std::numbers::pi / 6), std::sin(std::numbers::pi / 6), 0, 0};
    const std::string one = folder.path() / "one", two = folder.path() / "two", out = folder.path() / "out";
    write_run(one, {ring}, config);
    write_run(two, {ring, ring}, config);
    const Words fine{"--alpha-step-deg", "0.1", "--beta-step-deg", "0.1", "--out", out, "--json"};
    const auto with = [&fine](Words words) {
        words.insert(words.end(), fine.begin(), fine.end());
        return two_tier_program(words);
    };
    const Outcome run = with({"--path", one});
    ASSERT_EQ(run.status, 0) << run.err;
    const json result = json::parse(run.out);
    EXPECT_NEAR(result.at("height_mm")[0].get<double>(), 7 - 60 * std::sin(std::numbers::pi / 3), 1e-3);
    EXPECT_NEAR(result.at("height_mm")[1].get<double>(), 7 + 60 * std::sin(std::numbers::pi / 3), 1e-3);
    // From node to node in the ellipse's own angle: once round, and never off by more than a cell of 0.9 by 0.4 mm.
    double turned = 0, before = 0;
    for (const auto& row : read_table(fs::path(out) / "steps.csv").rows) {
        const double u = (row[5] - 100) / 60, v = (row[6] + 50) / 30, angle = std::atan2(v, u);
        EXPECT_LT(std::abs(std::hypot(u, v) - 1) * 60, 1.5);
        turned += row[0] > 0 ? std::remainder(angle - before, 2 * std::numbers::pi) : 0;
        before = angle;
    }
    EXPECT_NEAR(std::abs(turned), 2 * std::numbers::pi, 0.05) << "closed";
    EXPECT_EQ(with({"--path", two, "--seam", "1"}).out, run.out);
    EXPECT_THAT(two_tier_program({"--path", one}).out, HasSubstr("projected along z, which goes from -44.962 to"));
    EXPECT_THAT(with({"--path", two}).err, HasSubstr("has 2 seams; the path is one of them"));
    EXPECT_THAT(with({"--path", two, "--seam", "2"}).err, HasSubstr("--seam: 2; "));
    EXPECT_THAT(with({"--path", folder.path()}).err, HasSubstr("has no 4-models.json"));
}

TEST(MechanismCli, OneOfTheSeamsOfATable) {
    const TestFolder folder;
    const std::string file = folder.path() / "seams.csv";
    std::ofstream(file) << "seam,x,y,z\n0,1,2,3\n0,3,4,5\n1,100,0,8\n1,0,100,9\n";
    const Words fine{"--alpha-step-deg", "0.5", "--beta-step-deg", "0.25", "--json"};
    const auto with = [&fine](Words words) {
        words.insert(words.end(), fine.begin(), fine.end());
        return two_tier_program(words);
    };
    const Outcome run = with({"--path", file, "--seam", "1"});
    ASSERT_EQ(run.status, 0) << run.err;
    const json result = json::parse(run.out);
    EXPECT_EQ(result.at("height_mm"), json({8.0, 9.0}));
    const json same = json::parse(with({"--from", "100,0", "--to", "0,100"}).out);
    EXPECT_EQ(result.at("all"), same.at("all"));
    EXPECT_THAT(with({"--path", file}).err, HasSubstr("has 2 seams; the path is one of them"));
    EXPECT_THAT(with({"--path", file, "--seam", "5"}).err, HasSubstr("has no seam 5; its seams are 0 to 1"));
    EXPECT_THAT(with({"--from", "1,2", "--to", "3,4", "--seam", "0"}).err, HasSubstr("--seam: is for the seams"));
    std::ofstream(file) << "x,y\n1,2\n3,4\n";
    EXPECT_THAT(with({"--path", file, "--seam", "0"}).err, HasSubstr("has no column \"seam\""));
}

// On a path of 1 m, down to steps of both axes of a hundredth of a degree, from start to end of the program.
TEST(MechanismCli, TableOfAMetreTakesLessThanASecond) {
    const auto start = std::chrono::steady_clock::now();
    const Outcome run = two_tier_program({"--from", "-300,-400", "--to", "290,404", "--alpha-step-deg", "10",
                                          "--beta-step-deg", "10", "--table", "0.01", "--json"});
    const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    ASSERT_EQ(run.status, 0) << run.err;
    const json series = json::parse(run.out).at("series");
    EXPECT_LE(series.back().at("alpha_step_deg").get<double>(), 0.01);
    EXPECT_LE(series.back().at("beta_step_deg").get<double>(), 0.01);
    EXPECT_GT(series.back().at("beats").get<int>(), 8000);
    EXPECT_LT(took, 1 * SEAMPATH_SLOWDOWN);
}

TEST(MechanismCli, SaysWhatIsWrong) {
    const TestFolder folder;
    const std::string narrow = folder.path() / "narrow.csv";
    std::ofstream(narrow) << "x\n1\n2\n";
    const std::vector<std::pair<Words, std::string>> cases{
        {{"--from", "-350,-100", "--to", "400,380"}, "point 2 of the path, (400, 380) lies 551.725 mm"},
        {{}, "a path is needed, and one only"},
        {{"--from", "1,2"}, "a path is needed, and one only"},
        {paper_and({"--path", narrow}), "a path is needed, and one only"},
        {{"--path", narrow}, "there are no two columns for x and y"},
        {{"--path", "none.csv"}, "there is no file none.csv"},
        {{"--from", "1,2,3", "--to", "1,2"}, "--from: 3 numbers; a point X,Y in mm is needed"},
        {{"--from", "1,2", "--to", "1,2"}, "the path has no length"},
        {paper_and({"--method", "optimel"}), "did you mean \"optimal\"?"},
        {paper_and({"--alpha-step-deg", "7"}), "the step of alpha is 7 deg"},
        {paper_and({"--beta-step-deg", "nan"}), "the step of beta is nan deg"},
        {paper_and({"--radius-mm", "0"}), "the radius is 0 mm"},
        {paper_and({"--table", "0"}), "--table: 0 deg is no step"}};
    for (const auto& [words, message] : cases) {
        const Outcome run = two_tier_program(words);
        EXPECT_EQ(run.status, 2) << message;
        EXPECT_THAT(run.err, HasSubstr(message));
        EXPECT_EQ(run.out, "") << message;
    }
}

}  // namespace mechanism_cli_test
}  // namespace seampath
