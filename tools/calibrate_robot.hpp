#pragma once

#include <string>

#include "tools/commands.hpp"

/// `seampath calibrate tcp` and `hand-eye`.
namespace seampath {

struct RobotArguments {
    std::string file, out, date, reason;
    double limit_mm = 0;  ///< 0: as the file says
    bool accept = false, json = false;
};

CLI::App* tcp_app(CLI::App& calibrate, RobotArguments& given);
CLI::App* hand_eye_app(CLI::App& calibrate, RobotArguments& given);

int run_tcp(const RobotArguments& given);
int run_hand_eye(const RobotArguments& given);

}  // namespace seampath
