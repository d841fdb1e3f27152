#include "datasets/regression/judge.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace seampath {
namespace judge_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

SuiteCase a_case(const Band& band) {
    SuiteCase entry;
    entry.id = "part";
    entry.bands = {band};
    return entry;
}

CaseRun run_of(std::uint64_t seed, double value) {
    CaseRun run;
    run.id = "part";
    run.seed = seed;
    run.outcome = "seam";
    run.measured.add("rms_mm", value);
    return run;
}

std::vector<CaseRun> runs_of(const std::vector<double>& values) {
    std::vector<CaseRun> runs;
    for (const double value : values) {
        runs.push_back(run_of(runs.size() + 1, value));
    }
    return runs;
}

Baseline baseline_of(const std::vector<double>& values) {
    Baseline baseline;
    for (const CaseRun& run : runs_of(values)) {
        baseline.seeds[run.seed] = {run.outcome, run.measured};
    }
    return baseline;
}

CaseJudgement judged(const Band& band, const std::vector<double>& golden, const std::vector<double>& now) {
    return judge(a_case(band), runs_of(now), baseline_of(golden));
}

CaseVerdict verdict(const Band& band, const std::vector<double>& golden, const std::vector<double>& now) {
    return judged(band, golden, now).verdict;
}

TEST(Judge, TheAbsoluteBandHoldsToItsEdge) {
    const Band band{"rms_mm", 0.25, 0, Better::lower, Severity::fail};
    EXPECT_EQ(verdict(band, {1}, {1.25}), CaseVerdict::pass);
    EXPECT_EQ(verdict(band, {1}, {1.2501}), CaseVerdict::regression);
    EXPECT_EQ(verdict(band, {1}, {0.75}), CaseVerdict::pass);
    EXPECT_EQ(verdict(band, {1}, {0.7499}), CaseVerdict::stale);
}

TEST(Judge, TheRelativeBandIsOfTheGoldenValueAndTheLargerOneCounts) {
    const Band band{"rms_mm", 0.25, 0.5, Better::lower, Severity::fail};
    EXPECT_EQ(verdict(band, {4}, {6}), CaseVerdict::pass);
    EXPECT_EQ(verdict(band, {4}, {6.01}), CaseVerdict::regression);
    EXPECT_EQ(verdict(band, {-4}, {-2}), CaseVerdict::pass) << "a share has no sign";
}

TEST(Judge, DirectionsSayWhichChangeIsWorse) {
    const Band higher{"rms_mm", 0.1, 0, Better::higher, Severity::fail},
        both{"rms_mm", 0.1, 0, Better::both, Severity::fail};
    EXPECT_EQ(verdict(higher, {1}, {0.8}), CaseVerdict::regression);
    EXPECT_EQ(verdict(higher, {1}, {1.2}), CaseVerdict::stale);
    EXPECT_EQ(verdict(both, {1}, {0.8}), CaseVerdict::regression);
    EXPECT_EQ(verdict(both, {1}, {1.2}), CaseVerdict::regression);
}

// d = 0.03, 0.01, 0.02: mean 0.02, sd 0.01, 3 s = 3 * 0.01 / sqrt(3) = 0.01732.
TEST(Judge, ThePairedMeanIsHeldAgainstThreeOfItsStandardErrors) {
    const Band none{"rms_mm", 0, 0, Better::lower, Severity::fail};
    const CaseJudgement worse = judged(none, {1, 2, 3}, {1.03, 2.01, 3.02});
    EXPECT_EQ(worse.verdict, CaseVerdict::regression);
    EXPECT_NEAR(worse.metrics[0].difference, 0.02, 1e-12);
    EXPECT_NEAR(worse.metrics[0].allowed, 0.0173205, 1e-6);
    // The seeds differ by far more than that from each other: pairing is what shows it.
    EXPECT_EQ(verdict(none, {1, 2, 3}, {1.03, 1.99, 3.01}), CaseVerdict::pass) << "mean 0.01, 3 s = 0.0346";
}

// A mean never shows it: with d = D, 0, ..., 0 it is D / n and so is its standard error.
TEST(Judge, OneSeedGoneWrongShowsThoughTheMeanHidesIt) {
    const Band band{"rms_mm", 0.005, 0, Better::lower, Severity::fail};
    const CaseJudgement judgement = judged(band, {0.010, 0.012, 0.011, 0.013}, {0.010, 0.012, 0.511, 0.013});
    EXPECT_EQ(judgement.verdict, CaseVerdict::regression);
    EXPECT_THAT(judgement.reasons, ElementsAre(HasSubstr("seed 3 went from 0.011 to 0.511")));
    EXPECT_GT(judgement.metrics[0].allowed, judgement.metrics[0].difference);
}

TEST(Judge, ShiftsOfBothSignsDoNotHideBehindEachOther) {
    const Band both{"rms_mm", 0.01, 0, Better::both, Severity::fail};
    EXPECT_EQ(verdict(both, {0, 0}, {0.05, -0.05}), CaseVerdict::regression);
}

TEST(Judge, NumbersThatAreNoneAreTheSameOnlyAsOneAnother) {
    const Band band{"rms_mm", 1e9, 0, Better::lower, Severity::fail};
    const double infinite = std::numeric_limits<double>::infinity(), nan = std::nan("");
    EXPECT_EQ(verdict(band, {infinite}, {infinite}), CaseVerdict::pass);
    EXPECT_EQ(verdict(band, {nan}, {nan}), CaseVerdict::pass);
    EXPECT_EQ(verdict(band, {1}, {nan}), CaseVerdict::regression);
    EXPECT_EQ(verdict(band, {1}, {infinite}), CaseVerdict::regression);
    EXPECT_EQ(verdict(band, {infinite}, {1}), CaseVerdict::regression);
    EXPECT_EQ(verdict(band, {1, infinite}, {1, 1}), CaseVerdict::regression);
}

TEST(Judge, WhatIsMissingNeverPasses) {
    const Band band{"rms_mm", 1, 0, Better::lower, Severity::fail};
    std::vector<CaseRun> runs = runs_of({1});
    runs[0].measured.numbers.clear();
    EXPECT_EQ(judge(a_case(band), runs, baseline_of({1})).verdict, CaseVerdict::regression);
    EXPECT_EQ(judge(a_case(band), runs_of({1}), std::nullopt).verdict, CaseVerdict::no_baseline);
    EXPECT_EQ(judge(a_case(band), runs_of({1, 2}), baseline_of({1})).verdict, CaseVerdict::no_baseline);
    Baseline without = baseline_of({1});
    without.seeds[1].measured.numbers.clear();
    EXPECT_EQ(judge(a_case(band), runs_of({1}), without).verdict, CaseVerdict::no_baseline);
}

TEST(Judge, NotesAreSaidAndDoNotFail) {
    const Band band{"rms_mm", 0.1, 0, Better::lower, Severity::note};
    const CaseJudgement judgement = judged(band, {1}, {2});
    EXPECT_EQ(judgement.verdict, CaseVerdict::pass);
    EXPECT_THAT(judgement.reasons, ElementsAre(HasSubstr("note: rms_mm 1 -> 2")));
}

TEST(Judge, WhatNoBandFitsIsNotJudged) {
    EXPECT_THAT(judged({"other_mm", 0, 0, Better::lower, Severity::fail}, {1}, {2}).metrics, IsEmpty());
}

TEST(Judge, HashesAreTheSameOrNot) {
    SuiteCase entry = a_case({"program.*", 0, 0, Better::both, Severity::fail});
    std::vector<CaseRun> runs = runs_of({1});
    runs[0].measured.hashes = {{"program.abb.sha256", "aa"}};
    Baseline baseline = baseline_of({1});
    baseline.seeds[1].measured.hashes = {{"program.abb.sha256", "aa"}};
    EXPECT_EQ(judge(entry, runs, baseline).verdict, CaseVerdict::pass);
    baseline.seeds[1].measured.hashes[0].second = "bb";
    EXPECT_EQ(judge(entry, runs, baseline).verdict, CaseVerdict::regression);
}

TEST(Judge, OutcomesAreThoseExpected) {
    SuiteCase entry = a_case({"rms_mm", 1, 0, Better::lower, Severity::fail});
    entry.expect = Expectation::refused;
    entry.reason = "ends early";
    CaseRun run;
    run.outcome = "refused";
    run.message = "read: scan.ply ends early; a whole file was needed";
    EXPECT_EQ(judge(entry, {run}, std::nullopt).verdict, CaseVerdict::pass) << "a refusal needs no baseline";
    run.message = "read: another thing";
    EXPECT_EQ(judge(entry, {run}, std::nullopt).verdict, CaseVerdict::regression);
    EXPECT_EQ(judge(entry, runs_of({1}), baseline_of({1})).verdict, CaseVerdict::regression);
}

TEST(Judge, RecordedOutcomesAreThoseOfTheBaseline) {
    SuiteCase entry = a_case({"rms_mm", 1, 0, Better::lower, Severity::fail});
    entry.expect = Expectation::recorded;
    Baseline baseline = baseline_of({1});
    EXPECT_EQ(judge(entry, runs_of({1}), baseline).verdict, CaseVerdict::pass);
    baseline.seeds[1].outcome = "no seam";
    EXPECT_EQ(judge(entry, runs_of({1}), baseline).verdict, CaseVerdict::regression);
    EXPECT_EQ(judge(entry, runs_of({1}), std::nullopt).verdict, CaseVerdict::no_baseline);
}

TEST(Judge, ARunThatDidNotEndSaysSoAndNothingElse) {
    const Band band{"rms_mm", 1, 0, Better::lower, Severity::fail};
    std::vector<CaseRun> runs = runs_of({1, 5});
    runs[0].status = RunStatus::crashed;
    runs[0].message = "ended by a signal";
    const CaseJudgement crashed = judge(a_case(band), runs, baseline_of({1, 1}));
    EXPECT_EQ(crashed.verdict, CaseVerdict::failed);
    EXPECT_THAT(crashed.reasons, ElementsAre("seed 1: ended by a signal"));
    runs[0].status = RunStatus::data;
    EXPECT_EQ(judge(a_case(band), runs, baseline_of({1, 1})).verdict, CaseVerdict::no_data);
}

}  // namespace judge_test
}  // namespace seampath
