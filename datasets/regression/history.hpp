#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "datasets/regression/results.hpp"

/// Every run of a suite, kept in an SQLite database that other programs can read, too. Rows are added only: the
/// database itself refuses to change or remove one.
namespace seampath {

/// The mean of each metric over the seeds of one case.
struct HistoryCase {
    std::string id;
    std::string verdict;
    std::map<std::string, double> metrics;
};

struct HistoryRun {
    SuiteFacts facts;  ///< without suite_file
    std::string verdict;
    std::vector<HistoryCase> cases;
};

/// Adds a run, whole or not at all; the file is created when there is none. Throws InputError when it is no such
/// database or can't be written.
void add_to_suite_history(const std::filesystem::path& database, const SuiteResults& results);

/// All runs of a suite in the order in which they were written. Throws InputError when there is no such database.
std::vector<HistoryRun> read_suite_history(const std::filesystem::path& database, const std::string& suite);

}  // namespace seampath
