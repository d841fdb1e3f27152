#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "stages/options.hpp"
#include "stages/types.hpp"

namespace seampath {

enum class Robot { csv, json, abb, ur };
inline constexpr std::array<std::string_view, 4> kRobotNames{"csv", "json", "abb", "ur"};

struct ExportOptions {
    std::string robots = "csv,json,abb,ur";
    std::string program_name = "seampath";
    bool even_if_out_of_tolerance = false;
    std::string abb_tool = "tool0";
    std::string abb_work_object = "wobj0";
    std::string abb_seam_data;
    std::string abb_weld_data;
    std::string abb_zone = "z1";
    std::vector<double> ur_tcp = {0, 0, 0, 0, 0, 0};
    std::vector<double> base_from_scan = {0, 0, 0, 1, 0, 0, 0};      ///< x, y, z mm, qw, qx, qy, qz
};
Fields describe(ExportOptions&);

/// One file of a program, and what reading it back by an independent reader showed.
struct ProgramFile {
    std::string robot;                    ///< name of the robot, e.g. "abb"
    std::string file_name;                ///< without folder
    std::string content;
    double position_rounding_mm = 0;      ///< half a unit of the last written place
    double max_position_error_mm = 0;     ///< found when read back
    double max_orientation_error_deg = 0;
    double max_speed_error = 0;           ///< relative
};

/// Programs for every robot that `options.robots` names, each already read back and compared with the plan.
/// Throws InputError for an unknown robot (listing those there are), a bad name, or a value that the format can't hold.
std::vector<ProgramFile> export_programs(const Plan& plan, const ExportOptions& options);

}  // namespace seampath
