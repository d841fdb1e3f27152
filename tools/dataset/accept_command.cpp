#include <algorithm>
#include <iostream>
#include <memory>

#include "datasets/regression/compare.hpp"
#include "stages/error.hpp"
#include "tools/dataset/suite_commands.hpp"

namespace seampath {
namespace {

constexpr std::size_t kShownDifferences = 40;

struct AcceptArguments {
    std::string results, reason;
    std::vector<std::string> filter;
    bool all = false;
};

/// The baseline as results, so that it can be compared.
CaseResult as_result(const std::string& id, const Baseline& baseline) {
    CaseResult result;
    result.id = id;
    for (const auto& [seed, golden] : baseline.seeds) {
        CaseRun run;
        run.id = id;
        run.seed = seed;
        run.measured = golden.measured;
        result.runs.push_back(run);
    }
    return result;
}

/// What a run gives as a baseline. Throws InputError where it is none to hold others against.
Baseline baseline_of(const SuiteCase& entry, const CaseResult& result, const SuiteFacts& facts,
                     const std::string& reason) {
    Baseline baseline{entry.sha256, reason, facts.date, facts.commit, {}};
    for (const CaseRun& run : result.runs) {
        const std::string seed = entry.id + " seed " + std::to_string(run.seed);
        if (run.status != RunStatus::done) {
            throw InputError("accept: " + seed + " is not done: " + run.message +
                             "; only runs that ended can be accepted, so mend it, or leave the case out with --filter");
        }
        const std::string_view expected = kExpectationNames[static_cast<std::size_t>(entry.expect)];
        if (entry.expect != Expectation::recorded && run.outcome != expected) {
            throw InputError("accept: " + seed + " came out as \"" + run.outcome + "\", but the suite expects \"" +
                             std::string(expected) + "\"; change the row of the case, or mend the program");
        }
        baseline.seeds[run.seed] = {run.outcome, run.measured};
    }
    return baseline;
}

bool chosen(const AcceptArguments& given, const std::string& id) {
    return given.filter.empty() || std::any_of(given.filter.begin(), given.filter.end(), [&](const std::string& word) {
               return id.find(word) != std::string::npos;
           });
}

int accept(const AcceptArguments& given) {
    if (given.reason.empty()) {
        throw InputError("accept: a reason was needed; say with --reason TEXT why the results are right");
    }
    const SuiteResults results = read_results(given.results);
    const Suite suite = read_suite(results.facts.suite_file);
    SuiteResults before, after;
    std::vector<std::pair<const SuiteCase*, Baseline>> accepted;
    for (const CaseResult& result : results.cases) {
        const auto entry = std::find_if(suite.cases.begin(), suite.cases.end(),
                                        [&](const SuiteCase& one) { return one.id == result.id; });
        if (entry == suite.cases.end() || result.runs.empty() || !chosen(given, result.id)) {
            continue;
        }
        if (run_key(*entry, result.runs[0].seed, results.facts.build) != result.runs[0].key) {
            throw InputError("accept: the suite's row of " + entry->id +
                             " is not the one that was run; run the suite again, then accept");
        }
        if (const auto baseline = read_baseline(suite, *entry)) {
            before.cases.push_back(as_result(entry->id, *baseline));
            after.cases.push_back(result);
        }
        accepted.emplace_back(&*entry, baseline_of(*entry, result, results.facts, given.reason));
    }
    if (accepted.empty()) {
        throw InputError("accept: no case of " + given.results + " is chosen; check --filter");
    }
    // What no band fits is in no baseline, and no difference.
    std::vector<PairedDifference> differences = compare_results(before, after);
    std::erase_if(differences, [&](const PairedDifference& d) {
        return std::none_of(accepted.begin(), accepted.end(), [&](const auto& pair) {
            return pair.first->id == d.id && band_of(*pair.first, d.metric) != nullptr;
        });
    });
    for (const auto& [entry, baseline] : accepted) {
        write_baseline(suite, *entry, baseline);
    }
    std::cout << comparison_text(differences, given.all ? differences.size() : kShownDifferences) << accepted.size()
              << " baselines written, " << accepted.size() - before.cases.size() << " of them new: " << given.reason
              << "\n";
    return kSuitePass;
}

}  // namespace

Command dataset_accept_command(CLI::App& dataset) {
    CLI::App* app = dataset.add_subcommand("accept", "make the results of a run the baselines of its cases");
    const auto given = std::make_shared<AcceptArguments>();
    app->add_option("RESULTS", given->results, "--out folder of \"seampath dataset run\"")->required();
    app->add_option("--reason", given->reason, "why they are right; it is kept in each baseline");
    app->add_option("--filter", given->filter, "only cases with this in their name; may be repeated")
        ->allow_extra_args(false);
    app->add_flag("--all", given->all, "show every difference");
    app->footer(
        "Examples:\n"
        "  seampath dataset accept out/smoke --reason \"first baselines\"\n"
        "  seampath dataset accept out/smoke --filter v-groove --reason \"roots are found from both bevels\"\n"
        "  seampath dataset accept out/full --all --reason \"new noise model of the scanner\"\n");
    return {app, [given] { return accept(*given); }};
}

Command dataset_compare_command(CLI::App& dataset) {
    struct CompareArguments {
        std::string before, after;
        bool all = false;
    };
    CLI::App* app = dataset.add_subcommand("compare", "two results of a suite: paired differences, largest first");
    const auto given = std::make_shared<CompareArguments>();
    app->add_option("BEFORE", given->before, "--out folder of \"seampath dataset run\"")->required();
    app->add_option("AFTER", given->after, "another one")->required();
    app->add_flag("--all", given->all, "show every difference");
    app->footer(
        "Examples:\n"
        "  seampath dataset compare out/monday out/today\n"
        "  seampath dataset compare out/main out/branch --all\n"
        "  seampath dataset compare nightly/1 nightly/2 --all | grep saddle\n");
    return {app, [given] {
                const auto differences = compare_results(read_results(given->before), read_results(given->after));
                std::cout << comparison_text(differences, given->all ? differences.size() : kShownDifferences);
                return static_cast<int>(kSuitePass);
            }};
}

}  // namespace seampath
