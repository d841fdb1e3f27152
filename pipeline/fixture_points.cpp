#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>

#include "pipeline/files.hpp"
#include "pipeline/fixture_nominal.hpp"
#include "pipeline/text.hpp"
#include "stages/error.hpp"

namespace seampath {
namespace {

constexpr std::size_t kMaxPointBytes = std::size_t{4} << 20;
constexpr std::size_t kMaxSeamBytes = std::size_t{1} << 28;
constexpr std::array<std::string_view, 3> kUnits{"mm", "m", "inch"};
constexpr std::array<double, 3> kMmPerUnit{1, 1000, 25.4};

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view kBlanks = " \t\r";
    const auto first = text.find_first_not_of(kBlanks);
    return first == std::string_view::npos ? std::string_view{}
                                           : text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::vector<std::string_view> cells_of(std::string_view row) {
    std::vector<std::string_view> cells;
    const char separator = row.find(';') != std::string_view::npos ? ';' : ',';
    while (true) {
        const auto end = row.find(separator);
        cells.push_back(trimmed(row.substr(0, end)));
        if (end == std::string_view::npos) {
            return cells;
        }
        row = row.substr(end + 1);
    }
}

/// A table with a header, row by row: what a cell holds, and where it stands when it is wrong.
class TableReader {
public:
    TableReader(std::string file, std::vector<std::string> needed)
        : file_(std::move(file)), needed_(std::move(needed)) {}

    /// Calls take_row() for each row and take_comment(text) for each line that begins with #.
    template <class Comment, class Row>
    void read(std::string_view text, const Comment& take_comment, const Row& take_row) {
        while (!text.empty()) {
            const auto end = std::min(text.find('\n'), text.size());
            ++line_;
            const std::string_view row = trimmed(text.substr(0, end));
            if (row.starts_with('#')) {
                take_comment(trimmed(row.substr(1)));
            } else if (!row.empty() && columns_.empty()) {
                take_header(row);
            } else if (!row.empty()) {
                cells_ = cells_of(row);
                if (cells_.size() != width_) {
                    fail(std::to_string(cells_.size()) + " columns where the header has " + std::to_string(width_));
                }
                take_row();
            }
            text.remove_prefix(std::min(end + 1, text.size()));
        }
    }

    [[noreturn]] void fail(const std::string& what) const {
        throw InputError("points: " + file_ + ":" + std::to_string(line_) + ": " + what);
    }
    bool has(const std::string& column) const { return columns_.contains(column); }
    std::string text(const std::string& column) const { return std::string(cells_[columns_.at(column)]); }
    double number(const std::string& column) const {
        const std::string_view cell = cells_[columns_.at(column)];
        double value = NAN;
        const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
        if (error != std::errc{} || end != cell.data() + cell.size() || !std::isfinite(value)) {
            fail("column " + column + ": \"" + std::string(cell.substr(0, 40)) +
                 "\" is no finite number; one with a decimal point was needed");
        }
        return value;
    }
    Eigen::Vector3d point() const { return {number("x"), number("y"), number("z")}; }

private:
    void take_header(std::string_view row) {
        const auto cells = cells_of(row);
        for (std::size_t i = 0; i < cells.size(); ++i) {
            columns_[std::string(cells[i])] = i;
        }
        std::string header;
        for (const std::string& column : needed_) {
            header += (header.empty() ? "" : ",") + column;
        }
        for (const std::string& column : needed_) {
            if (!columns_.contains(column)) {
                fail("there is no column \"" + column + "\"; a header " + header + " was needed");
            }
        }
        width_ = cells.size();
    }

    std::string file_;
    std::vector<std::string> needed_;
    std::size_t line_ = 0, width_ = 0;
    std::map<std::string, std::size_t> columns_;
    std::vector<std::string_view> cells_;
};

/// What a comment says that the numbers are in, as mm.
void take_unit(const TableReader& table, std::string_view comment, double& mm_per_unit) {
    constexpr std::string_view kUnit = "unit:";
    if (!comment.starts_with(kUnit)) {
        return;
    }
    const std::string unit(trimmed(comment.substr(kUnit.size())));
    const auto known = std::find(kUnits.begin(), kUnits.end(), unit);
    if (known == kUnits.end()) {
        table.fail("the unit \"" + unit + "\" is unknown; there are " + join(kUnits));
    }
    mm_per_unit = kMmPerUnit[static_cast<std::size_t>(known - kUnits.begin())];
}

}  // namespace

std::vector<TouchedRow> read_touched_points(const std::filesystem::path& file, double sigma_mm) {
    TableReader table(file.string(), {"name", "x", "y", "z"});
    std::vector<TouchedRow> rows;
    std::set<std::string> seen;
    double mm_per_unit = 1;
    const auto take_row = [&] {
        TouchedRow row{table.text("name"), mm_per_unit * table.point(), sigma_mm};
        if (table.has("sigma_mm")) {
            row.sigma_mm = table.number("sigma_mm");
        }
        if (!(row.sigma_mm > 0)) {
            table.fail("there is no 1-sigma above 0 for \"" + row.name +
                       "\"; give a column sigma_mm, or sigma_mm in the nominal file");
        }
        if (!seen.insert(row.name).second) {
            table.fail("\"" + row.name + "\" stands twice");
        }
        rows.push_back(row);
    };
    table.read(
        read_file(file, kMaxPointBytes, "points"),
        [&](std::string_view comment) { take_unit(table, comment, mm_per_unit); }, take_row);
    if (rows.empty()) {
        table.fail("there is no touched point; a header name,x,y,z and a row a point were needed");
    }
    return rows;
}

std::vector<std::vector<MeasuredSeamPoint>> read_measured_seams(const std::filesystem::path& file) {
    const bool folder = std::filesystem::is_directory(file);
    const std::filesystem::path points = folder ? file / "seam_points.csv" : file;
    TableReader table(points.string(), {"seam", "x", "y", "z", "sigma_mm"});
    std::map<std::string, std::vector<MeasuredSeamPoint>> seams;
    const auto take_row = [&] {
        const double sigma = table.number("sigma_mm");
        if (!(sigma > 0)) {
            table.fail("the 1-sigma " + table.text("sigma_mm") + " mm is not above 0");
        }
        seams[table.text("seam")].push_back({table.point(), sigma});
    };
    table.read(
        read_file(points, kMaxSeamBytes, "points"), [](std::string_view) {}, take_row);
    if (seams.empty()) {
        table.fail("there is no seam point; seam_points.csv of a run, or the run's folder, was needed");
    }
    std::vector<std::vector<MeasuredSeamPoint>> list;
    for (auto& [number, seam] : seams) {
        list.push_back(std::move(seam));
    }
    return list;
}

}  // namespace seampath
