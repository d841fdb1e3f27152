#pragma once

#include <string>

#include "tools/commands.hpp"

/// `seampath calibrate camera` and `laser`.
namespace seampath {

struct OpticsArguments {
    std::string file, out, date;
    bool json = false;
};

CLI::App* camera_app(CLI::App& calibrate, OpticsArguments& given);
CLI::App* laser_app(CLI::App& calibrate, OpticsArguments& given);

int run_camera(const OpticsArguments& given);
int run_laser(const OpticsArguments& given);

}  // namespace seampath
