#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <string>
#include <utility>

#include "stages/error.hpp"
#include "stages/export/text.hpp"

/// waypoints.csv: comment lines that say frame, unit and quaternion order, a line of column names, a line a waypoint.
/// Numbers are in their shortest exact form, so nothing is rounded.
namespace seampath::exporting {
namespace csv_format {

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    while (true) {
        const auto end = text.find(separator);
        parts.push_back(text.substr(0, end));
        if (end == std::string_view::npos) {
            return parts;
        }
        text.remove_prefix(end + 1);
    }
}

// Columns by their names: their order is the file's own business.
class Row {
public:
    Row(const std::map<std::string_view, std::size_t>& column, std::vector<std::string_view> cells, std::size_t line)
        : column_(column), cells_(std::move(cells)), line_(line) {
        require(cells_.size() == column_.size(), "as many cells as columns");
    }
    std::string_view text(std::string_view name) const {
        const auto found = column_.find(name);
        require(found != column_.end(), name);
        return cells_[found->second];
    }
    double number(std::string_view name) const {
        const std::string_view cell = text(name);
        double value = 0;
        const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
        require(error == std::errc() && end == cell.data() + cell.size(), name);
        return value;
    }
    WaypointKind kind() const {
        const auto found = std::find(kWaypointKindNames.begin(), kWaypointKindNames.end(), text("kind"));
        require(found != kWaypointKindNames.end(), "kind");
        return static_cast<WaypointKind>(found - kWaypointKindNames.begin());
    }

private:
    void require(bool holds, std::string_view needed) const {
        if (!holds) {
            throw InternalError("export: waypoints.csv:" + std::to_string(line_) + ": " + std::string(needed) +
                                " was needed");
        }
    }

    const std::map<std::string_view, std::size_t>& column_;
    std::vector<std::string_view> cells_;
    std::size_t line_;
};

Waypoint waypoint(const Row& row) {
    Waypoint w;
    w.seam = static_cast<int>(row.number("seam"));
    w.index = static_cast<int>(row.number("index"));
    w.kind = row.kind();
    w.station_mm = row.number("station_mm");
    w.p = {row.number("x"), row.number("y"), row.number("z")};
    w.q = Eigen::Quaterniond(row.number("qw"), row.number("qx"), row.number("qy"), row.number("qz"));
    w.speed_mm_s = row.number("speed_mm_s");
    w.time_s = row.number("time_s");
    w.sigma_mm = row.number("sigma_mm");
    return w;
}

std::vector<TextFile> write(const Program& program, const ExportOptions& options) {
    std::string text;
    for (const std::string& line : preamble(program, options, 0)) {
        text += "# " + line + "\n";
    }
    text += "# Units: mm, mm/s, s. Quaternion order: qw,qx,qy,qz (base_from_tool, scalar first).\n";
    text += "seam,index,kind,station_mm,x,y,z,qw,qx,qy,qz,speed_mm_s,time_s,sigma_mm\n";
    for (const Target& target : program.targets) {
        const Waypoint& w = target.at;
        text += std::to_string(w.seam) + "," + std::to_string(w.index) + "," + std::string(name(w.kind)) + "," +
                list({w.station_mm, w.p.x(), w.p.y(), w.p.z(), w.q.w(), w.q.x(), w.q.y(), w.q.z(), w.speed_mm_s,
                      w.time_s, w.sigma_mm},
                     ",") +
                "\n";
    }
    return {{"waypoints.csv", text}};
}

std::vector<Target> read(const std::vector<TextFile>& files) {
    std::vector<Target> targets;
    std::map<std::string_view, std::size_t> column;
    std::size_t number = 0;
    for (const std::string_view line : split(files.at(0).text, '\n')) {
        ++number;
        if (line.empty() || line.front() == '#') {
            continue;
        }
        const std::vector<std::string_view> cells = split(line, ',');
        if (column.empty()) {
            for (std::size_t i = 0; i < cells.size(); ++i) {
                column[cells[i]] = i;
            }
            continue;
        }
        targets.push_back({waypoint(Row(column, cells, number))});
    }
    return targets;
}

}  // namespace csv_format

constinit const Format kCsv{
    "csv",           0, kAnywhere, 0, false, false, Axes::none, true, tells_everything, no_problems, csv_format::write,
    csv_format::read};

}  // namespace seampath::exporting
