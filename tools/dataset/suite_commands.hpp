#pragma once

#include <functional>
#include <vector>

#include "tools/commands.hpp"

/// The subcommands of `seampath dataset` that work on suites of regression cases.
namespace seampath {

/// Exit statuses of `dataset run`; of a fault of the suite's own program, and when it was stopped, those of ExitStatus.
enum SuiteStatus {
    kSuitePass = 0,
    kSuiteRegression = 1,
    kSuiteUsage = 2,
    kSuiteNoData = 3,
    kSuiteFailed = 4,
    kSuiteNoBaseline = 5
};

/// Exit status of the process of a case that got no more memory.
inline constexpr int kChildOutOfMemory = 71;

Command dataset_run_command(CLI::App& dataset);
/// One case with one seed, in a process of its own; dataset run starts it, and it is in no help.
Command dataset_case_command(CLI::App& dataset);
Command dataset_compare_command(CLI::App& dataset);
Command dataset_accept_command(CLI::App& dataset);
Command dataset_history_command(CLI::App& dataset);

}  // namespace seampath
