#pragma once

#include <string>

#include <CLI/CLI.hpp>

/// `seampath calibrate history` and `seampath calibrate study`.
namespace seampath {

struct StudyArguments {
    std::string folder;
    double limit_mm = 0.2;
    bool json = false;
};

CLI::App* history_app(CLI::App& calibrate, StudyArguments& given);
CLI::App* study_app(CLI::App& calibrate, StudyArguments& given);

int print_history(const StudyArguments& given);
int print_study(const StudyArguments& given);

}  // namespace seampath
