#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "stages/options.hpp"
#include "stages/types.hpp"

namespace seampath {

/// Every robot, in the order of the table of formats in export.cpp, which has a row for each.
inline constexpr std::array<std::string_view, 10> kRobotNames{"csv", "json",    "abb",      "kuka", "fanuc",
                                                              "ur",  "yaskawa", "linuxcnc", "ros",  "noether"};

/// Numbers and names of what lives on the controller are the cell's own: those that a language can't do without have no
/// default, and naming that robot without them is an error.
struct ExportOptions {
    std::string robots = "csv,json,abb,ur";
    std::string program_name = "seampath";
    bool even_if_out_of_tolerance = false;
    std::vector<double> base_from_scan = {0, 0, 0, 1, 0, 0, 0};  ///< x, y, z mm, qw, qx, qy, qz
    std::optional<double> base_from_scan_sigma_mm;               ///< 1-sigma of a calibration, for the programs' heads
    std::optional<double> base_from_scan_sigma_deg;
    bool arc_moves = true;  ///< where the language has them
    double arc_tolerance_mm = 0.02;
    double arc_tolerance_deg = 0.1;
    double joint_speed_percent = 10;  ///< of moves along the axes, where the language wants a share of their speeds
    std::string arm_robot;            ///< the robot whose axes the plan's arm has; empty: none
    std::string arm_joints;           ///< names of its axes, comma-separated

    std::string abb_tool = "tool0";
    std::string abb_work_object = "wobj0";
    std::string abb_seam_data;
    std::string abb_weld_data;
    std::string abb_weave_data;
    std::string abb_zone = "z1";

    std::optional<double> kuka_tool;
    std::optional<double> kuka_base;  ///< none: the robot's own base
    std::string kuka_arc_on;          ///< sub-programs of the controller
    std::string kuka_arc_off;
    bool kuka_spline = false;
    double kuka_approximation_mm = 0.5;

    std::optional<double> fanuc_tool;
    std::optional<double> fanuc_user_frame;
    std::string fanuc_configuration;  ///< e.g. "N U T, 0, 0, 0"
    std::optional<double> fanuc_arc_start;
    std::optional<double> fanuc_arc_end;
    std::optional<double> fanuc_weave;

    std::vector<double> ur_tcp = {0, 0, 0, 0, 0, 0};  ///< x, y, z mm, rotation vector rad
    std::optional<double> ur_arc_output;              ///< standard digital output that strikes the arc

    std::optional<double> yaskawa_tool;
    std::optional<double> yaskawa_user_frame;    ///< none: the robot's own base
    std::string yaskawa_speed_unit;              ///< what V= means is a parameter of the controller
    std::string yaskawa_configuration;           ///< numbers of ///RCONF
    std::vector<double> yaskawa_pulses_per_deg;  ///< of the axes; needed where the plan's arm is a Yaskawa
    std::optional<double> yaskawa_arc_start;
    std::optional<double> yaskawa_arc_end;
    std::optional<double> yaskawa_weave;

    std::optional<double> linuxcnc_tool;         ///< none: the one that is in use
    std::optional<double> linuxcnc_work_offset;  ///< 1 to 9: G54 to G59.3; none: the one that is in use
    std::optional<double> linuxcnc_arc_output;
    double linuxcnc_tolerance_mm = 0.01;

    std::string ros_frame = "base_link";
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
    double max_speed_error = 0;     ///< relative
    double max_axis_error_deg = 0;  ///< of moves along the axes
    double max_path_error_mm = 0;   ///< largest distance of the plan's waypoints from the moves as read back
    double max_path_turn_deg = 0;   ///< the same of their orientations
    std::size_t moves = 0;          ///< of the program
};

/// Programs for every robot that `options.robots` names, each already read back and compared with the plan: every pose
/// within the format's rounding and 0.001 deg, every speed within 0.5 %, every axis of a move along them within 0.001
/// deg, same order, same process events; where straight moves were joined or replaced by arcs, every waypoint between
/// within the arc tolerances. Poses are written in the base frame, base_from_scan * pose. Where the plan has an arm,
/// the robot that options.arm_robot names goes through the air by that arm's axes, and ROS gets them all along. Throws
/// InputError for all that export_problems() finds, and for a value that a format can't hold.
std::vector<ProgramFile> export_programs(const Plan& plan, const ExportOptions& options);

}  // namespace seampath
