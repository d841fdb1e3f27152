#include "pipeline/compare.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pipeline/artefact.hpp"
#include "pipeline/codec.hpp"
#include "pipeline/config.hpp"
#include "pipeline/digest.hpp"
#include "pipeline/files.hpp"
#include "pipeline/report.hpp"
#include "tests/cli/spawn.hpp"
#include "tests/report/example_part.hpp"

/// Runs whose curves were moved by known lengths.
namespace seampath::test {
namespace compare_test {

using Eigen::Vector3d;
using testing::HasSubstr;

/// What compare needs of a run's folder.
void write_run(const std::filesystem::path& folder, const PartResult& part) {
    const RunFolder run(folder);
    run.write("config.resolved.json", config_json(part.config));
    run.write("4-models.json", artefact_text("fit", sha256("key"), encode(part.models)));
    run.write("5-deviation.json", artefact_text("validate", sha256("key"), encode(part.deviations)));
    run.write("report.json", report_json(part));
}

void move_seam(PartResult& part, std::size_t seam, const Vector3d& by) {
    for (Vector3d& p : part.models[seam].curve.control) {
        p += by;
    }
}

class Compare : public testing::Test {
protected:
    RunComparison against(const PartResult& b) {
        write_run(folder_.path() / "a", example_part());
        write_run(folder_.path() / "b", b);
        return compare_runs(folder_.path() / "a", folder_.path() / "b");
    }
    std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
    const TestFolder folder_;
};

Difference find(const RunComparison& comparison, const std::string& of, const std::string& name) {
    for (const Difference& d : comparison.differences) {
        if (d.of == of && d.name == name) {
            return d;
        }
    }
    ADD_FAILURE() << "no " << name << " of " << of;
    return {};
}

TEST_F(Compare, ARunDoesNotDifferFromItself) {
    const RunComparison c = against(example_part());
    EXPECT_TRUE(c.pass);
    EXPECT_EQ(c.pairs.size(), 2U);
    EXPECT_TRUE(c.settings.empty());
    for (const Difference& d : c.differences) {
        EXPECT_LT(std::abs(d.difference.value_or(0)), 1e-9) << d.name;
    }
}

// Both curves have sigmas of 0.012 mm, together 0.017, of which 3.41 are 0.0579; the tolerance is 0.1 mm.
TEST_F(Compare, ADistanceIsJudgedBySigmasAndTolerance) {
    for (const auto& [moved_mm, verdict] :
         {std::pair(0.05, DifferenceVerdict::same), std::pair(0.08, DifferenceVerdict::tolerated),
          std::pair(0.12, DifferenceVerdict::differs)}) {
        PartResult part = example_part();
        move_seam(part, 1, {0, 0, moved_mm});  // the rib lies along x
        const RunComparison c = against(part);
        const Difference d = find(c, "seam 1", "distance_p997_mm");
        EXPECT_NEAR(*d.difference, moved_mm, 1e-9);
        EXPECT_NEAR(*d.sigma, std::hypot(0.012, 0.012), 1e-12);
        EXPECT_EQ(d.verdict, verdict) << moved_mm;
        EXPECT_EQ(c.pass, verdict != DifferenceVerdict::differs);
        // Up is midway between z and y, across is square to it.
        EXPECT_NEAR(*find(c, "seam 1", "up_median_mm").difference, moved_mm * std::sqrt(0.5), 1e-9);
        EXPECT_NEAR(std::abs(*find(c, "seam 1", "across_median_mm").difference), moved_mm * std::sqrt(0.5), 1e-9);
        EXPECT_NEAR(*find(c, "seam 0", "distance_p997_mm").difference, 0, 1e-9);
    }
}

TEST_F(Compare, TheWorstComesFirst) {
    PartResult part = example_part();
    move_seam(part, 0, {0, 0, 0.5});
    move_seam(part, 1, {0, 0, 0.3});
    const RunComparison c = against(part);
    EXPECT_EQ(c.differences[0].of, "seam 0");
    EXPECT_EQ(c.differences[0].name, "distance_p997_mm");
    EXPECT_NEAR(c.differences[0].share(), 5, 1e-6);
    EXPECT_EQ(c.differences[1].of, "seam 1");
    EXPECT_THAT(c.sentence, HasSubstr("the worst is distance_p997_mm of seam 0: 0.500, allowed 0.100"));
}

TEST_F(Compare, SeamsArePairedByWhereTheyLie) {
    PartResult part = example_part();
    std::swap(part.models[0], part.models[1]);
    std::swap(part.deviations[0], part.deviations[1]);
    std::swap(part.extraction.seams[0], part.extraction.seams[1]);
    std::swap(part.nodes[0], part.nodes[1]);
    const RunComparison c = against(part);
    ASSERT_EQ(c.pairs.size(), 2U);
    EXPECT_EQ(c.pairs[0].b, 1U);
    EXPECT_EQ(c.pairs[1].b, 0U);
    EXPECT_NEAR(*find(c, "seam 0 / 1", "distance_p997_mm").difference, 0, 1e-9);
}

TEST_F(Compare, ASeamWithoutAPartnerDiffers) {
    PartResult part = example_part();
    move_seam(part, 1, {0, 0, 40});
    const RunComparison c = against(part);
    EXPECT_FALSE(c.pass);
    EXPECT_EQ(c.pairs.size(), 1U);
    EXPECT_EQ(find(c, "seam 1", "found").verdict, DifferenceVerdict::differs);
}

// The radius has a sigma of 0.004 mm in both runs: together 0.00566, three of which are 0.017.
TEST_F(Compare, ADimensionIsJudgedByItsSigma) {
    for (const auto& [by, verdict] :
         {std::pair(0.016, DifferenceVerdict::same), std::pair(0.018, DifferenceVerdict::differs)}) {
        PartResult part = example_part();
        part.models[0].saddle->branch_radius_mm.value += by;
        const Difference d = find(against(part), "seam 0", "branch_radius_mm");
        EXPECT_NEAR(*d.difference, by, 1e-9);
        EXPECT_EQ(d.verdict, verdict);
    }
}

TEST_F(Compare, OtherVerdictsAndSettingsShow) {
    PartResult part = example_part(false);
    part.config.plan.speed_mm_s = 6;
    const RunComparison c = against(part);
    EXPECT_EQ(find(c, "seam 1", "in_tolerance").verdict, DifferenceVerdict::differs);
    ASSERT_EQ(c.settings.size(), 1U);
    EXPECT_EQ(c.settings[0].name, "plan/speed_mm_s");
    EXPECT_EQ(find(c, "part", "duration_s").verdict, DifferenceVerdict::told);
}

TEST_F(Compare, TheCommandPrintsTheWorstFirstAndEndsWithOneWhereSomethingDiffers) {
    PartResult part = example_part();
    move_seam(part, 1, {0, 0, 0.3});
    against(part);
    const Outcome same = Process({"compare", path("a"), path("a")}).wait();
    EXPECT_EQ(same.status, 0);
    EXPECT_THAT(same.out, testing::StartsWith("same: 2 seams compared"));
    const Outcome other = Process({"compare", path("a"), path("b"), "--json", "--out", path("page.html")}).wait();
    EXPECT_EQ(other.status, 1) << other.err;
    const auto json = nlohmann::json::parse(other.out);
    EXPECT_EQ(json.at("verdict"), "fail");
    EXPECT_EQ(json.at("differences")[0].at("name"), "distance_p997_mm");
    EXPECT_NEAR(json.at("differences")[0].at("difference").get<double>(), 0.3, 1e-9);
    const std::string page = text_of(folder_.path() / "page.html");
    EXPECT_THAT(page, HasSubstr("data-value=\"" + json.at("differences")[0].at("difference").dump() + "\""));

    const Outcome none = Process({"compare", path("a"), path("nothing")}).wait();
    EXPECT_EQ(none.status, 2);
    EXPECT_THAT(none.err, HasSubstr("has no report.json; a folder that \"seampath run\" wrote was needed"));
    std::ofstream(folder_.path() / "b" / "4-models.json") << "{}";
    const Outcome damaged = Process({"compare", path("a"), path("b")}).wait();
    EXPECT_EQ(damaged.status, 2);
    EXPECT_THAT(damaged.err, HasSubstr("is no whole artefact of the stage fit"));
}

}  // namespace compare_test
}  // namespace seampath::test
