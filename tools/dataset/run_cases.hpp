#pragma once

#include <filesystem>
#include <vector>

#include "datasets/regression/case_run.hpp"

namespace seampath {

/// One case with one seed that is to be run, and its folder.
struct CaseJob {
    const SuiteCase* entry;
    std::uint64_t seed;
    std::filesystem::path folder;
};

/// Runs every job in a process of its own, so many at once, and tells of each on stderr; on a terminal a bar shows how
/// far it is. A run that crashes, takes longer or more memory than its case allows ends alone, and its CaseRun says so.
/// With `resume`, runs of the same key that are done already are taken over. Throws Interrupted when asked to stop.
/// Returns the runs in the order of the jobs.
std::vector<CaseRun> run_cases(const std::filesystem::path& suite_file, const std::vector<CaseJob>& jobs, int at_once,
                               bool resume);

}  // namespace seampath
