#pragma once

#include <functional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "tools/exit_status.hpp"

/// The subcommands of `seampath`, one file each.
namespace seampath {

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
Command interpolate_command(CLI::App& program);
Command parametrize_command(CLI::App& program);
Command saddle_command(CLI::App& program);
Command mechanism_command(CLI::App& program);
Command compare_command(CLI::App& program);
Command report_command(CLI::App& program);
Command calibrate_command(CLI::App& program);

}  // namespace seampath
