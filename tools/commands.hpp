#pragma once

#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

/// The subcommands of `seampath`, one file each.
namespace seampath {

/// Exit status of the program; `run` of several scans ends with the largest of its parts.
enum ExitStatus { kPass = 0, kOutOfTolerance = 1, kBadInput = 2, kOwnFault = 3, kInterrupted = 130 };

/// A subcommand and what it does once the command line is read.
struct Command {
    CLI::App* app = nullptr;
    std::function<int()> act;
};

Command run_command(CLI::App& program);
Command check_command(CLI::App& program);
Command info_command(CLI::App& program);
Command options_command(CLI::App& program);
Command dataset_command(CLI::App& program);

}  // namespace seampath
