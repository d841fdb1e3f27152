#include <algorithm>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iostream>
#include <memory>
#include <system_error>
#include <thread>

#include <sys/utsname.h>

#include "datasets/regression/history.hpp"
#include "datasets/regression/results.hpp"
#include "datasets/regression/suite_page.hpp"
#include "pipeline/digest.hpp"
#include "pipeline/files.hpp"
#include "pipeline/text.hpp"
#include "stages/error.hpp"
#include "stages/geometry/parallel.hpp"
#include "tools/dataset/child_process.hpp"
#include "tools/dataset/run_cases.hpp"
#include "tools/dataset/suite_commands.hpp"
#include "tools/stop_signal.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;

struct SuiteArguments {
    std::string suite, out, shard, history, commit;
    std::vector<std::string> filter;
    int jobs = static_cast<int>(usable_processors());
    bool resume = false, json = false;
};

/// "2/3" as which of how many, from 1.
std::pair<std::size_t, std::size_t> shard_of(const std::string& text) {
    std::size_t part = 1, parts = 1;
    char rest = 0;
    if (!text.empty() && (std::sscanf(text.c_str(), "%zu/%zu%c", &part, &parts, &rest) != 2 || part < 1 ||
                          part > parts || text.find('-') != std::string::npos)) {
        throw InputError("--shard: \"" + text + "\" is no shard; one of several like 1/3, 2/3, 3/3 was needed");
    }
    return {part, parts};
}

/// A word of --filter takes cases of that tag, and those whose name holds it.
bool taken_by(const std::vector<std::string>& filter, const SuiteCase& entry) {
    return filter.empty() || std::any_of(filter.begin(), filter.end(), [&](const std::string& word) {
               return entry.id.find(word) != std::string::npos ||
                      std::find(entry.tags.begin(), entry.tags.end(), word) != entry.tags.end();
           });
}

std::vector<const SuiteCase*> chosen_cases(const Suite& suite, const SuiteArguments& given) {
    const auto [part, parts] = shard_of(given.shard);
    std::vector<const SuiteCase*> chosen;
    std::size_t index = 0;
    for (const SuiteCase& entry : suite.cases) {
        if (taken_by(given.filter, entry) && index++ % parts == part - 1) {
            chosen.push_back(&entry);
        }
    }
    if (chosen.empty()) {
        std::vector<std::string_view> names;
        for (const SuiteCase& entry : suite.cases) {
            names.push_back(entry.id);
        }
        throw InputError("dataset: no case is left to run; the suite's are " + join(names));
    }
    return chosen;
}

std::string now() {
    const std::time_t time = std::time(nullptr);
    std::tm utc{};
    gmtime_r(&time, &utc);
    char text[32];
    std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
    return text;
}

/// Of the suite's folder, as git tells it; "unknown" where it can't.
std::string commit_of(const Suite& suite, const fs::path& out) {
    const fs::path answer = out / "commit.txt";
    ChildProcess git({"git", "-C", suite.folder.string(), "describe", "--always", "--dirty", "--abbrev=12"}, answer);
    std::string line;
    if (git.wait().status == 0) {
        std::ifstream in(answer);
        std::getline(in, line);
    }
    fs::remove(answer);
    return line.empty() ? "unknown" : line;
}

/// Runs on machines of one class may be compared by their times.
std::string machine_class() {
    utsname system{};
    uname(&system);
    std::string model = "unknown processor";
    std::ifstream info("/proc/cpuinfo");
    for (std::string line; std::getline(info, line);) {
        if (line.starts_with("model name")) {
            model = line.substr(std::min(line.size(), line.find(':') + 2));
            break;
        }
    }
    return std::string(system.machine) + ", " + std::to_string(usable_processors()) + " x " + model;
}

int status_of(CaseVerdict verdict) {
    switch (verdict) {
        case CaseVerdict::pass:
        case CaseVerdict::stale:
            return kSuitePass;
        case CaseVerdict::no_baseline:
            return kSuiteNoBaseline;
        case CaseVerdict::regression:
            return kSuiteRegression;
        case CaseVerdict::no_data:
            return kSuiteNoData;
        case CaseVerdict::failed:
            return kSuiteFailed;
    }
    ensure(false, "every verdict has its exit status");
    return kOwnFault;
}

SuiteResults judged(const Suite& suite, const std::vector<const SuiteCase*>& chosen, std::vector<CaseRun> runs) {
    SuiteResults results;
    std::size_t next = 0;
    for (const SuiteCase* entry : chosen) {
        CaseResult result;
        result.id = entry->id;
        for (std::size_t i = 0; i < entry->seeds.size(); ++i) {
            result.runs.push_back(std::move(runs[next++]));
        }
        result.judgement = judge(*entry, result.runs, read_baseline(suite, *entry));
        results.cases.push_back(std::move(result));
    }
    return results;
}

int run_suite(const SuiteArguments& given) {
    watch_stop_signals();
    const Suite suite = read_suite(given.suite);
    const auto chosen = chosen_cases(suite, given);
    for (const SuiteCase* entry : chosen) {
        read_baseline(suite, *entry);  // what is wrong with one shows before the work
    }
    const RunFolder out(given.out);
    const fs::path folder = fs::absolute(out.path());
    if (!given.resume) {
        out.remove("cases");
    }
    std::vector<CaseJob> jobs;
    for (const SuiteCase* entry : chosen) {
        for (const std::uint64_t seed : entry->seeds) {
            jobs.push_back({entry, seed, folder / "cases" / entry->id / std::to_string(seed)});
        }
    }
    const fs::path suite_file =
        fs::absolute(fs::is_directory(given.suite) ? fs::path(given.suite) / "suite.json" : fs::path(given.suite));
    SuiteResults results = judged(suite, chosen, run_cases(suite_file, jobs, given.jobs, given.resume));
    results.facts = {suite.name, suite_file,     now(), given.commit.empty() ? commit_of(suite, folder) : given.commit,
                     build_id(), machine_class()};
    const fs::path history = given.history.empty() ? folder / "history.db" : fs::path(given.history);
    add_to_suite_history(history, results);
    const std::string json = results_json(results);
    out.write("results.json", json);
    out.write("junit.xml", junit_xml(results));
    out.write("index.html", suite_page(results, read_suite_history(history, suite.name), folder));
    std::cout << (given.json ? json : results_table(results));
    std::cerr << suite.name << ": " << kCaseVerdictNames[static_cast<std::size_t>(verdict_of(results))] << "; "
              << (folder / "index.html").string() << "\n";
    return status_of(verdict_of(results));
}

struct CaseArguments {
    std::string suite, id, out;
    std::uint64_t seed = 0;
};

int run_one_case(const CaseArguments& given) {
    const Suite suite = read_suite(given.suite);
    const auto entry =
        std::find_if(suite.cases.begin(), suite.cases.end(), [&](const SuiteCase& one) { return one.id == given.id; });
    if (entry == suite.cases.end()) {
        throw InputError("dataset: the suite has no case \"" + given.id + "\"; name one of its rows");
    }
    const fs::path folder = given.out;
    try {
        const CaseRun run = run_case(*entry, given.seed, folder);
        RunFolder(folder).write("result.json", case_run_json(run));
        return kPass;
    } catch (const std::bad_alloc&) {
    } catch (const std::system_error& error) {
        if (error.code() != std::errc::resource_unavailable_try_again) {  // no room for one more thread
            throw;
        }
    }
    std::cerr << "memory: there is not enough for this case\n";
    return kChildOutOfMemory;
}

}  // namespace

Command dataset_case_command(CLI::App& dataset) {
    CLI::App* app = dataset.add_subcommand("case", "one case with one seed")->group("");
    const auto given = std::make_shared<CaseArguments>();
    app->add_option("SUITE", given->suite)->required();
    app->add_option("CASE", given->id)->required();
    app->add_option("SEED", given->seed)->required();
    app->add_option("--out", given->out)->required();
    return {app, [given] { return run_one_case(*given); }};
}

Command dataset_run_command(CLI::App& dataset) {
    CLI::App* app = dataset.add_subcommand("run", "run a suite of cases and hold them against their baselines");
    const auto given = std::make_shared<SuiteArguments>();
    app->add_option("SUITE", given->suite, "suite.json, or its folder")->required();
    app->add_option("--out", given->out, "folder for results.json, junit.xml, index.html and the runs")->required();
    app->add_option("--jobs", given->jobs, "runs at once")->check(CLI::Range(1, 1024))->capture_default_str();
    app->add_option("--shard", given->shard, "i/n: every n-th case, from the i-th");
    app->add_option("--filter", given->filter, "only cases of this tag, or with this in their name; may be repeated")
        ->allow_extra_args(false);
    app->add_flag("--resume", given->resume, "take over the runs that are done in --out, of this build");
    app->add_option("--history", given->history, "database that the run is added to (default: history.db in --out)");
    app->add_option("--commit", given->commit, "what the history calls this state of the code (default: git's name)");
    app->add_flag("--json", given->json, "print results.json instead of the table");
    app->footer(
        "Examples:\n"
        "  seampath dataset run datasets/suites/smoke --out out/smoke\n"
        "  seampath dataset run datasets/suites/full --out out/full --shard 2/4 --history nightly.db\n"
        "  seampath dataset run datasets/suites/smoke --out out/smoke --filter saddle --resume\n"
        "Exit status: 0 pass, 1 a case got worse, 2 bad input, 3 data missing or other than the suite says, 4 a crash, "
        "or more time or memory than a case may take, 5 no baseline; of several the worst, in the order 4, 3, 1, 5. "
        "130 interrupted\n");
    return {app, [given] { return run_suite(*given); }};
}

}  // namespace seampath
