#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "stages/export/export.hpp"
#include "stages/types.hpp"

/// Private to the export stage: what a robot language must bring. Each has a .cpp with its writer and its row's
/// numbers, and one with a reader that is written from the language's own rules; export.cpp holds the table of them.
namespace seampath::exporting {

struct TextFile {
    std::string name;  ///< without folder
    std::string text;
};

/// Where the axes of an arm stand at one moment.
struct AxisPoint {
    double time_s = 0;           ///< since the program's first target; 0 where the language tells no times
    std::array<double, 6> q{};   ///< rad
    std::array<double, 6> dq{};  ///< rad/s; 0 likewise
};

/// What a language tells of an arm's axes, where the plan has them. `air`: moves along the axes through the air, for
/// the robot that the arm is. `all`: their whole travel, of any arm.
enum class Axes { none, air, all };

/// How the tool gets to a target. `joint`: along the robot's axes. `via`: the point on the way of the circular move
/// that ends in the next target.
enum class Move { joint, linear, via, circular };

/// One point of a program.
struct Target {
    Waypoint at;
    Move move = Move::linear;
    std::size_t waypoint = 0;  ///< of the plan: the one it stands for, or heads for where a move was divided
    /// Of the arm: Axes::air, where it stands at the end of a move along the axes, which then tells no pose; Axes::all,
    /// on the way here and here.
    std::vector<AxisPoint> axes{};
    bool passed = false;  ///< as read: on the way, within what the language rounds corners by, and not stopped in
};

struct Program {
    Plan plan;  ///< in the base frame
    std::vector<Target> targets;
    double deviation_mm = 0;  ///< of the moves from the seam's curve, at most
};

/// What a file tells of a target beside its pose, speed and move. `everything`: all fields of the waypoint. `welding`:
/// where the arc starts and ends; the reader gives kinds weld_start, weld and weld_end, and air for all else. `motion`:
/// nothing; all air.
enum class Told { everything, welding, motion };

struct Format {
    std::string_view name;
    double position_rounding_mm;  ///< half a unit of the last written place, each coordinate
    double max_coordinate_mm;     ///< beyond it the format or the robot can't hold a position
    double min_speed_mm_s;        ///< below it the written speed is off by more than 0.5 %
    bool joint_start;             ///< the first move is along the axes: where the robot comes from is not known
    bool arcs;                    ///< the language has circular moves
    Axes axes;
    bool speeds;  ///< files tell speeds; a joint move's may be NaN, where it is a share of the axes' own
    Told (*told)(const ExportOptions&);
    std::vector<std::string> (*problems)(const ExportOptions&);  ///< as export_problems()
    std::vector<TextFile> (*write)(const Program&, const ExportOptions&);
    std::vector<Target> (*read)(const std::vector<TextFile>&);  ///< throws InternalError naming file and line
    /// What the language needs other targets for than the plan's own; nullptr: nothing.
    std::vector<Target> (*prepare)(std::vector<Target>) = nullptr;
};

extern const Format kCsv, kJson, kAbb, kKuka, kFanuc, kUr, kYaskawa, kLinuxcnc, kRos, kNoether;
std::vector<Target> read_abb(const std::vector<TextFile>&);
std::vector<Target> read_kuka(const std::vector<TextFile>&);
std::vector<Target> read_fanuc(const std::vector<TextFile>&);
std::vector<Target> read_ur(const std::vector<TextFile>&);
std::vector<Target> read_yaskawa(const std::vector<TextFile>&);
std::vector<Target> read_linuxcnc(const std::vector<TextFile>&);
std::vector<Target> read_ros(const std::vector<TextFile>&);
std::vector<Target> read_noether(const std::vector<TextFile>&);

/// Every row, in the order of kRobotNames.
const Format& format(std::size_t robot);

Told tells_everything(const ExportOptions&);
std::vector<std::string> no_problems(const ExportOptions&);

/// Gives the targets what the format tells of the plan's arm.
void add_axes(Program& program, const Format& format, const ExportOptions& options);

/// The plan's waypoints as moves of that format.
Program program_of(const Plan& in_base, const Format& format, const ExportOptions& options);

/// Largest difference of an orientation, and of an axis, from the plan when it is read back.
inline constexpr double kMaxOrientationError_deg = 0.001;

/// How far the plan's waypoints lie from the moves that pass them.
struct PathCheck {
    double max_error_mm = 0;
    double max_turn_deg = 0;
};

/// Of a program as it was read back; compare() has found each of its targets where it was written. Throws InternalError
/// naming the first move that leaves the waypoints by more than the arc tolerances.
PathCheck check_path(const Program& program, const Format& format, const std::vector<Target>& read,
                     const ExportOptions& options);

/// What reading back showed.
struct ReadBack {
    double max_position_error_mm = 0;
    double max_orientation_error_deg = 0;
    double max_speed_error = 0;
    double max_axis_error_deg = 0;
};

/// Compares what was read with what was to be written. Throws InternalError naming the first waypoint that differs by
/// more than the format allows.
ReadBack compare(const Format& format, Told told, const std::vector<Target>& written, const std::vector<Target>& read);

}  // namespace seampath::exporting
