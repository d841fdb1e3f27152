#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "stages/export/export.hpp"
#include "stages/types.hpp"

/// Private to the export stage: what a robot language must bring. Each has one .cpp with its writer and a reader that
/// is written from the language's own rules; export.cpp holds the table of them.
namespace seampath::exporting {

struct TextFile {
    std::string name;  ///< without folder
    std::string text;
};

/// What a file tells of a waypoint beside its pose and speed. `everything`: all fields. `welding`: where the arc starts
/// and ends; the reader gives kinds weld_start, weld and weld_end, and air for all else. `motion`: nothing; all air.
enum class Told { everything, welding, motion };

struct Format {
    std::string_view name;
    double position_rounding_mm;  ///< half a unit of the last written place, each coordinate
    double max_coordinate_mm;     ///< beyond it the format or the robot can't hold a position
    double min_speed_mm_s;        ///< below it the written speed is off by more than 0.5 %
    Told (*told)(const ExportOptions&);
    std::vector<std::string> (*problems)(const ExportOptions&);  ///< as export_problems()
    std::vector<TextFile> (*write)(const Plan& in_base, const ExportOptions&);
    std::vector<Waypoint> (*read)(const std::vector<TextFile>&);  ///< throws InternalError naming file and line
};

std::vector<TextFile> write_csv(const Plan& in_base, const ExportOptions&);
std::vector<Waypoint> read_csv(const std::vector<TextFile>&);

std::vector<TextFile> write_json(const Plan& in_base, const ExportOptions&);
std::vector<Waypoint> read_json(const std::vector<TextFile>&);

inline constexpr double kAbbRounding_mm = 0.0005;
Told abb_told(const ExportOptions&);
std::vector<std::string> abb_problems(const ExportOptions&);
std::vector<TextFile> write_abb(const Plan& in_base, const ExportOptions&);
std::vector<Waypoint> read_abb(const std::vector<TextFile>&);

inline constexpr double kUrRounding_mm = 0.0005;
Told ur_told(const ExportOptions&);
std::vector<std::string> ur_problems(const ExportOptions&);
std::vector<TextFile> write_ur(const Plan& in_base, const ExportOptions&);
std::vector<Waypoint> read_ur(const std::vector<TextFile>&);

/// Every row, in the order of kRobotNames.
const Format& format(std::size_t robot);

/// What reading back showed.
struct ReadBack {
    double max_position_error_mm = 0;
    double max_orientation_error_deg = 0;
    double max_speed_error = 0;
};

/// Compares what was read with what was to be written. Throws InternalError naming the first waypoint that differs by
/// more than the format allows.
ReadBack compare(const Format& format, Told told, const std::vector<Waypoint>& plan, const std::vector<Waypoint>& read);

}  // namespace seampath::exporting
