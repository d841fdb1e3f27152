#include <cmath>
#include <numbers>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "stages/geometry/sampled_spline.hpp"
#include "tests/cli/spawn.hpp"
#include "tests/papers/tables.hpp"
#include "tests/papers/written_run.hpp"

namespace seampath {
namespace saddle_from_test {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using Words = std::vector<std::string>;

constexpr double kDegree = std::numbers::pi / 180;

/// Nothing but what `--from` looks at: its curve is not.
SeamModel fitted(double r, double R, double angle_deg, double offset) {
    SeamModel model;
    model.model = "saddle";
    model.reason = "the pipe is round";
    model.saddle = SaddleParameters{SurfaceShape::cylinder, Measured{r, 0.02}, Measured{R, 0.05},
                                    Measured{angle_deg * kDegree, 0.03 * kDegree}, Measured{offset, 0.04}};
    return model;
}

SeamModel no_saddle() {
    SeamModel model = fitted(30, 80, 90, 0);
    model.saddle.reset();
    model.model = "spline";
    model.reason = "no saddle: neither flank is a cylinder";
    return model;
}

Outcome from(const fs::path& run, const fs::path& out, const Words& more) {
    Words words{"saddle", "--from", run, "--out", out};
    words.insert(words.end(), more.begin(), more.end());
    return seampath_program(words);
}

// A branch that is thicker by d moves every place of its wall out by d, however the header bends below it.
TEST(SaddleFrom, AThickerBranchIsThatFarOffItsWall) {
    const TestFolder folder;
    write_run(folder.path() / "run", {fitted(30.2, 80, 90, 0)});
    const Outcome run = from(folder.path() / "run", folder.path() / "out",
                             {"--branch-radius-mm", "30", "--header-radius-mm", "80", "--json"});
    ASSERT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(run.out, text_of(folder.path() / "out" / "saddle_difference.json"));
    const json seam = json::parse(run.out).at("seams").at(0);
    EXPECT_EQ(seam.at("dimensions")[0].at("name"), "branch_radius_mm");
    EXPECT_NEAR(seam.at("dimensions")[0].at("difference").get<double>(), 0.2, 1e-12);
    EXPECT_NEAR(seam.at("dimensions")[0].at("difference_in_sigmas").get<double>(), 10, 1e-9);
    ASSERT_EQ(seam.at("places").size(), 360u);
    double worst = 0;
    for (const json& place : seam.at("places")) {
        const double theta = place.at("theta_deg").get<double>() * kDegree;
        EXPECT_NEAR(place.at("branch_wall_mm").get<double>(), 0.2, 1e-9);
        // Closed form of the upright saddle: z = sqrt(R^2 - r^2 sin^2).
        const auto z = [&](double r) { return std::sqrt(80 * 80 - std::pow(r * std::sin(theta), 2)); };
        EXPECT_NEAR(place.at("difference_mm")[0].get<double>(), 0.2 * std::sin(theta), 1e-9);
        EXPECT_NEAR(place.at("difference_mm")[1].get<double>(), 0.2 * std::cos(theta), 1e-9);
        EXPECT_NEAR(place.at("difference_mm")[2].get<double>(), z(30.2) - z(30), 1e-9);
        // Both points lie on the header.
        EXPECT_LT(std::abs(place.at("header_wall_mm").get<double>()), 3e-4);
        worst = std::max(worst, place.at("distance_mm").get<double>());
        EXPECT_GT(place.at("sigma_mm").get<double>(), 0.01);
        EXPECT_LT(place.at("sigma_mm").get<double>(), 0.2);
    }
    EXPECT_NEAR(seam.at("max_mm").get<double>(), worst, 1e-12);
    EXPECT_EQ(read_table(folder.path() / "out" / "saddle_difference.csv").rows.size(), 360u);
    const std::string plot = text_of(folder.path() / "out" / "saddle_difference.svg");
    EXPECT_THAT(plot, AllOf(testing::StartsWith("<svg xmlns"), HasSubstr("seam 0: branch angle"),
                            testing::Not(HasSubstr("nan"))));
}

// The sigma of one dimension alone, against the closed form.
TEST(SaddleFrom, SigmaFollowsFromTheDimensions) {
    const TestFolder folder;
    SeamModel model = fitted(30, 80, 90, 0);
    model.saddle->header_radius_mm->sigma = model.saddle->angle_rad->sigma = model.saddle->offset_mm->sigma = 0;
    write_run(folder.path() / "run", {model});
    const Outcome run = from(folder.path() / "run", folder.path() / "out",
                             {"--branch-radius-mm", "30", "--header-radius-mm", "80", "--json"});
    ASSERT_EQ(run.status, 0) << run.err;
    const json crown = json::parse(run.out).at("seams").at(0).at("places").at(0);
    EXPECT_NEAR(crown.at("sigma_mm").get<double>(), 0.02, 1e-6);
    EXPECT_EQ(crown.at("distance_mm").get<double>(), 0);
}

// A branch with four bulges of 0.1 mm, scanned from elsewhere and followed the other way round: they are the difference
// from a round one of its size, and come on top of that from a thinner one.
TEST(SaddleFrom, TheSeamsOwnFormIsPartOfTheDifference) {
    const TestFolder folder;
    const auto bulge = [](double theta) { return 0.1 * std::cos(4 * theta); };
    const Eigen::Isometry3d scan_from_saddle =
        Eigen::Translation3d(100, -20, 5) * Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized());
    SeamModel bulged = fitted(30, 80, 90, 0);
    bulged.model = "saddle with smooth offsets";
    bulged.closed = true;
    const auto at = [&](double u) -> Eigen::Vector3d {
        const double theta = 1 - u / 30, r = 30 + bulge(theta), x = r * std::sin(theta);
        return scan_from_saddle * Eigen::Vector3d(x, r * std::cos(theta), std::sqrt(80 * 80 - x * x));
    };
    bulged.curve = spline_through(at, 60 * std::numbers::pi, true, 1e-7).curve;
    write_run(folder.path() / "run", {bulged});
    for (const double nominal : {30.0, 29.8}) {
        const Outcome run = from(folder.path() / "run", folder.path() / "out",
                                 {"--branch-radius-mm", std::to_string(nominal), "--header-radius-mm", "80", "--json"});
        ASSERT_EQ(run.status, 0) << run.err;
        const json seam = json::parse(run.out).at("seams").at(0);
        EXPECT_EQ(json::parse(run.out).at("remark"), "");
        for (const json& place : seam.at("places")) {
            const double theta = place.at("theta_deg").get<double>() * kDegree;
            EXPECT_NEAR(place.at("branch_wall_mm").get<double>(), 30 - nominal + bulge(theta), 1e-3) << theta;
            EXPECT_NEAR(place.at("header_wall_mm").get<double>(), 0, 1e-3) << theta;
            EXPECT_GE(place.at("form_mm").get<double>(), std::abs(bulge(theta)) - 1e-3) << theta;
        }
    }
}

TEST(SaddleFrom, SidesAreThoseOfTheDrawing) {
    const TestFolder folder;
    write_run(folder.path() / "run", {fitted(30, 80, 60, 10)});
    const Outcome run =
        from(folder.path() / "run", folder.path() / "out",
             {"--branch-radius-mm", "30", "--header-radius-mm", "80", "--angle-deg", "120", "--offset-mm", "-10"});
    ASSERT_EQ(run.status, 0) << run.err;
    EXPECT_THAT(run.out, AllOf(HasSubstr("angle_deg"), HasSubstr("120.0000"), HasSubstr("-10.0000"),
                               HasSubstr("largest distance 0.0000 mm"), HasSubstr("saddle_difference.{csv,json,svg}")));
}

TEST(SaddleFrom, ReportsAllSaddlesOrTheOneAskedFor) {
    const TestFolder folder;
    Config config;
    config.fit.branch_radius_mm = {30, 0.1};
    SeamModel oval = fitted(30.1, 80, 90, 0);  // with ends
    oval.model = "saddle with smooth offsets";
    write_run(folder.path() / "run", {fitted(30, 80, 90, 0), no_saddle(), oval}, config);
    const Words nominal{"--branch-radius-mm", "30", "--header-radius-mm", "80"};
    const Outcome all = from(folder.path() / "run", folder.path() / "out", nominal);
    ASSERT_EQ(all.status, 0) << all.err;
    EXPECT_THAT(all.out, AllOf(HasSubstr("seam 0 is a saddle"), HasSubstr("seam 2 is a saddle"),
                               HasSubstr("the fit knew dimensions beforehand"),
                               HasSubstr("; seam 2: the fitted seam's smooth offsets from its saddle are not in")));
    Words one = nominal;
    one.insert(one.end(), {"--seam", "2", "--json"});
    const Outcome second = from(folder.path() / "run", folder.path() / "out", one);
    EXPECT_EQ(json::parse(second.out).at("seams").size(), 1u);
    EXPECT_EQ(json::parse(second.out).at("seams")[0].at("seam"), 2);
}

TEST(SaddleFrom, WithoutNominalDimensionsTakesTheFittedOnes) {
    const TestFolder folder;
    write_run(folder.path() / "run", {fitted(30.2, 80, 75, 4)});
    const Outcome run = from(folder.path() / "run", folder.path() / "out", {"--robot", "csv", "--json"});
    ASSERT_EQ(run.status, 0) << run.err;
    const json facts = json::parse(run.out);
    EXPECT_EQ(facts.at("dimensions").at("branch_radius_mm"), 30.2);
    EXPECT_NEAR(facts.at("dimensions").at("angle_deg").get<double>(), 75, 1e-12);
    EXPECT_TRUE(fs::exists(folder.path() / "out" / "programs" / "csv"));
}

TEST(SaddleFrom, SaysWhatIsWrong) {
    const TestFolder folder;
    const fs::path run = folder.path() / "run", none = folder.path() / "none", two = folder.path() / "two",
                   cone = folder.path() / "cone", damaged = folder.path() / "damaged";
    write_run(run, {fitted(30, 80, 90, 0)});
    write_run(none, {no_saddle()});
    write_run(two, {fitted(30, 80, 90, 0), fitted(30, 80, 90, 0)});
    SeamModel on_cone = fitted(30, 80, 90, 0);
    on_cone.saddle->header = SurfaceShape::cone;
    write_run(cone, {on_cone});
    write_run(damaged, {fitted(30, 80, 90, 0)});
    std::ofstream(damaged / "4-models.json", std::ios::app) << " ";
    fs::resize_file(damaged / "4-models.json", fs::file_size(damaged / "4-models.json") / 2);
    const Words nominal{"--branch-radius-mm", "30", "--header-radius-mm", "80"};
    const auto with = [&](const Words& more) {
        Words words = nominal;
        words.insert(words.end(), more.begin(), more.end());
        return words;
    };
    const std::vector<std::tuple<fs::path, Words, std::string>> cases{
        {none, nominal, "holds no fitted saddle: seam 0 is a spline (no saddle: neither flank is a cylinder)"},
        {folder.path() / "nowhere", nominal, "has no 4-models.json"},
        {damaged, nominal, "4-models.json is no whole artefact"},
        {two, {}, "holds 2 saddles; say which one with --seam"},
        {run, with({"--seam", "1"}), "--seam: 1; the run has 1 seams"},
        {run, with({"--seam", "-1"}), "--seam: -1"},
        {run, with({"--step", "arc-length"}), "--step: is for a torch path"},
        {run, {"--header-radius-mm", "80"}, "--header-radius-mm: the dimensions are those of the run"},
        {run,
         {"--header", "plane", "--branch-radius-mm", "30"},
         "was fitted as a cylinder, the nominal one is a plane"},
        {run, {"--branch-radius-mm", "80", "--header-radius-mm", "30"}, "partial penetration"},
        {cone, nominal, "the fitted header is a cone"}};
    for (const auto& [source, words, message] : cases) {
        const Outcome outcome = from(source, folder.path() / "out", words);
        EXPECT_EQ(outcome.status, 2) << message;
        EXPECT_THAT(outcome.err, HasSubstr(message));
        EXPECT_EQ(outcome.out, "") << message;
        EXPECT_FALSE(fs::exists(folder.path() / "out" / "saddle_difference.csv")) << message;
    }
    const Outcome alone = seampath_program(
        {"saddle", "--out", folder.path() / "out", "--branch-radius-mm", "30", "--header", "plane", "--seam", "0"});
    EXPECT_THAT(alone.err, HasSubstr("--seam: is for the run that --from names"));
}

}  // namespace saddle_from_test
}  // namespace seampath
