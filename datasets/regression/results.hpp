#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "datasets/regression/judge.hpp"

/// What a run of a suite leaves: `results.json`, which accept and compare read, `junit.xml` and a table.
namespace seampath {

/// When, of what and on what a suite was run.
struct SuiteFacts {
    std::string suite;
    std::filesystem::path suite_file;
    std::string date;  ///< ISO 8601, UTC
    std::string commit;
    std::string build;    ///< SHA-256 of the program
    std::string machine;  ///< its class: architecture, processor, number of them
};

struct CaseResult {
    std::string id;
    std::vector<CaseRun> runs;  ///< one a seed
    CaseJudgement judgement;
};

struct SuiteResults {
    SuiteFacts facts;
    std::vector<CaseResult> cases;
};

/// The worst verdict of all cases.
CaseVerdict verdict_of(const SuiteResults& results);

/// The mean of a metric over the runs of a case that have it; NaN where none has.
double mean_metric(const CaseResult& result, const std::string& metric);

std::string results_json(const SuiteResults& results);

/// Facts and runs of `results.json` in the folder, without judgements. Throws InputError when there is none.
SuiteResults read_results(const std::filesystem::path& folder);

/// One test case a case of the suite: JUnit's XML as Jenkins and GitLab read it.
std::string junit_xml(const SuiteResults& results);

/// A row a case, then the reasons of those that did not simply pass.
std::string results_table(const SuiteResults& results);

}  // namespace seampath
