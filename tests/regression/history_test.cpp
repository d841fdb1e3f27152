#include "datasets/regression/history.hpp"

#include <cmath>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include "datasets/regression/compare.hpp"
#include "stages/error.hpp"
#include "tests/test_folder.hpp"

namespace seampath {
namespace suite_history_test {

using testing::HasSubstr;

SuiteResults results_of(const std::string& commit, double first, double second) {
    SuiteResults results;
    results.facts = {"smoke", "", "2026-11-30T06:00:00Z", commit, "build", "machine"};
    CaseResult& result = results.cases.emplace_back();
    result.id = "tee";
    result.judgement.verdict = CaseVerdict::regression;
    for (const double value : {first, second}) {
        CaseRun& run = result.runs.emplace_back();
        run.id = "tee";
        run.seed = result.runs.size();
        run.measured.add("rms_mm", value);
        run.measured.add("same_mm", 1);
    }
    return results;
}

TEST(SuiteHistory, KeepsEveryRunInItsOrder) {
    const TestFolder folder;
    const auto file = folder.path() / "history.db";
    add_to_suite_history(file, results_of("one", 1, 2));
    add_to_suite_history(file, results_of("two", 3, 5));
    const auto runs = read_suite_history(file, "smoke");
    ASSERT_EQ(runs.size(), 2U);
    EXPECT_EQ(runs[0].facts.commit, "one");
    EXPECT_EQ(runs[1].verdict, "regression");
    ASSERT_EQ(runs[1].cases.size(), 1U);
    EXPECT_EQ(runs[0].cases[0].metrics.at("rms_mm"), 1.5) << "the mean over the seeds";
    EXPECT_EQ(runs[1].cases[0].metrics.at("rms_mm"), 4);
    EXPECT_TRUE(read_suite_history(file, "full").empty());
}

TEST(SuiteHistory, IsOnlyAddedTo) {
    const TestFolder folder;
    const auto file = folder.path() / "history.db";
    add_to_suite_history(file, results_of("one", 1, 2));
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
    for (const char* sql : {"DELETE FROM suite_run", "UPDATE suite_metric SET value = 0", "DELETE FROM suite_case"}) {
        EXPECT_NE(sqlite3_exec(database, sql, nullptr, nullptr, nullptr), SQLITE_OK) << sql;
        EXPECT_THAT(sqlite3_errmsg(database), HasSubstr("only added to"));
    }
    sqlite3_close(database);
    EXPECT_EQ(read_suite_history(file, "smoke").size(), 1U);
}

TEST(SuiteHistory, RefusesWhatIsNone) {
    const TestFolder folder;
    EXPECT_THROW(read_suite_history(folder.path() / "none.db", "smoke"), InputError);
    std::ofstream(folder.path() / "text.db") << std::string(5000, 'x');
    EXPECT_THROW(add_to_suite_history(folder.path() / "text.db", results_of("one", 1, 2)), InputError);
}

TEST(CompareResults, TellsPairedDifferencesLargestFirst) {
    const auto differences = compare_results(results_of("one", 1, 2), results_of("two", 1.5, 2.7));
    ASSERT_EQ(differences.size(), 1U) << "what is the same is left out";
    EXPECT_EQ(differences[0].metric, "rms_mm");
    EXPECT_NEAR(differences[0].difference, 0.6, 1e-12);
    EXPECT_NEAR(differences[0].deviation, std::sqrt(0.02), 1e-12);  // of 0.5 and 0.7
    EXPECT_THAT(comparison_text({}, 9), HasSubstr("no metric of any case differs"));
}

TEST(CompareResults, SeedsThatOnlyOneHasComeFirst) {
    SuiteResults after = results_of("two", 1.5, 2);
    after.cases[0].runs[1].measured.numbers.pop_back();
    const auto differences = compare_results(results_of("one", 1, 2), after);
    ASSERT_EQ(differences.size(), 2U);
    EXPECT_EQ(differences[0].metric, "same_mm");
    EXPECT_TRUE(std::isinf(differences[0].difference));
}

// Differences of both signs, whose mean is 0, are differences.
TEST(CompareResults, DifferencesThatCancelAreShown) {
    EXPECT_EQ(compare_results(results_of("one", 1, 2), results_of("two", 1.5, 1.5)).size(), 1U);
}

}  // namespace suite_history_test
}  // namespace seampath
