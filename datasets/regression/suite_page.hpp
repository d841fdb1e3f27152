#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "datasets/regression/history.hpp"

namespace seampath {

/// index.html of a suite's run: one page that works offline. The verdict; a row a case, worst first, with a drawing of
/// the part, the numbers now and in the baseline, how they went over the runs of the history, and links to the report
/// of each seed; below each row every metric that is judged. `folder` is the run's, from which the drawings are taken.
std::string suite_page(const SuiteResults& results, const std::vector<HistoryRun>& history,
                       const std::filesystem::path& folder);

}  // namespace seampath
