#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "stages/options.hpp"
#include "stages/types.hpp"

namespace seampath {

/// Every robot, in the order of the table of formats in export.cpp, which does not compile if the two differ.
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
    std::vector<double> ur_tcp = {0, 0, 0, 0, 0, 0};             ///< x, y, z mm, rotation vector rad
    std::optional<double> ur_arc_output;                         ///< standard digital output that strikes the arc
    std::vector<double> base_from_scan = {0, 0, 0, 1, 0, 0, 0};  ///< x, y, z mm, qw, qx, qy, qz
};
Fields describe(ExportOptions&);

/// What no single field's bounds can say: unknown robots, names that a language does not take, options that need each
/// other. Each reads "key: what is wrong, with the value; what was needed"; empty when all is well.
std::vector<std::string> export_problems(const ExportOptions& options);

/// One file of a program, and what reading it back by an independent reader showed.
struct ProgramFile {
    std::string robot;      ///< name of the robot, e.g. "abb"
    std::string file_name;  ///< without folder
    std::string content;
    double position_rounding_mm = 0;   ///< half a unit of the last written place
    double max_position_error_mm = 0;  ///< found when read back
    double max_orientation_error_deg = 0;
    double max_speed_error = 0;  ///< relative
};

/// Programs for every robot that `options.robots` names, each already read back and compared with the plan: every pose
/// within the format's rounding and 0.001 deg, every speed within 0.5 %, same order, same process events. Poses are
/// written in the base frame, base_from_scan * pose.
/// Throws InputError for all that export_problems() finds, and for a value that a format can't hold.
std::vector<ProgramFile> export_programs(const Plan& plan, const ExportOptions& options);

}  // namespace seampath
