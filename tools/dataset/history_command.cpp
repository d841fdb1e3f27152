#include <iostream>
#include <memory>

#include "datasets/regression/history.hpp"
#include "pipeline/text.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"
#include "tools/dataset/suite_commands.hpp"

namespace seampath {
namespace {

struct SuiteHistoryArguments {
    std::string database, suite = "smoke", id;
    std::string metric = "fitted_rms_mm";
};

/// Of one case a row a run with the metric; without a case only what was run.
int print_suite_history(const SuiteHistoryArguments& given) {
    const std::vector<HistoryRun> runs = read_suite_history(given.database, given.suite);
    if (runs.empty()) {
        throw InputError("history: " + given.database + " has no run of a suite \"" + given.suite +
                         "\"; name one with --suite");
    }
    std::vector<std::vector<std::string>> rows{{"date", "commit", "verdict", "machine"}};
    if (!given.id.empty()) {
        rows[0].insert(rows[0].begin() + 3, {given.metric, "case"});
    }
    for (const HistoryRun& run : runs) {
        std::vector<std::string> row{run.facts.date, run.facts.commit, run.verdict, run.facts.machine};
        if (!given.id.empty()) {
            std::string value = "-", verdict = "-";
            for (const HistoryCase& one : run.cases) {
                const auto metric = one.metrics.find(given.metric);
                value = one.id == given.id && metric != one.metrics.end() ? shortest(metric->second) : value;
                verdict = one.id == given.id ? one.verdict : verdict;
            }
            row.insert(row.begin() + 3, {value, verdict});
        }
        rows.push_back(row);
    }
    std::cout << aligned(rows);
    return kSuitePass;
}

}  // namespace

Command dataset_history_command(CLI::App& dataset) {
    CLI::App* app = dataset.add_subcommand("history", "the runs of a suite in the order in which they were made");
    const auto given = std::make_shared<SuiteHistoryArguments>();
    app->add_option("DATABASE", given->database, "history.db of \"seampath dataset run\"")->required();
    app->add_option("--suite", given->suite, "name of the suite")->capture_default_str();
    app->add_option("--case", given->id, "show a metric of this case");
    app->add_option("--metric", given->metric, "which one, its mean over the seeds")->capture_default_str();
    app->footer(
        "Examples:\n"
        "  seampath dataset history out/smoke/history.db\n"
        "  seampath dataset history out/smoke/history.db --case lap --metric fitted_max_mm\n"
        "  seampath dataset history nightly.db --suite full --case tee-metrology\n");
    return {app, [given] { return print_suite_history(*given); }};
}

}  // namespace seampath
