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

class PointReader {
public:
    PointReader(std::string file, double sigma_mm) : file_(std::move(file)), sigma_mm_(sigma_mm) {}

    std::vector<TouchedRow> read(std::string_view text) {
        while (!text.empty()) {
            const auto end = std::min(text.find('\n'), text.size());
            ++line_;
            const std::string_view row = trimmed(text.substr(0, end));
            if (row.starts_with('#')) {
                take_comment(trimmed(row.substr(1)));
            } else if (!row.empty() && columns_.empty()) {
                take_header(row);
            } else if (!row.empty()) {
                take_row(row);
            }
            text.remove_prefix(std::min(end + 1, text.size()));
        }
        if (rows_.empty()) {
            fail("there is no touched point; a header name,x,y,z and a row a point were needed");
        }
        return std::move(rows_);
    }

private:
    [[noreturn]] void fail(const std::string& what) const {
        throw InputError("points: " + file_ + ":" + std::to_string(line_) + ": " + what);
    }

    void take_comment(std::string_view comment) {
        constexpr std::string_view kUnit = "unit:";
        if (!comment.starts_with(kUnit)) {
            return;
        }
        const std::string unit(trimmed(comment.substr(kUnit.size())));
        for (std::size_t i = 0; i < kUnits.size(); ++i) {
            if (unit == kUnits[i]) {
                mm_per_unit_ = kMmPerUnit[i];
                return;
            }
        }
        fail("the unit \"" + unit + "\" is unknown; there are " + join(kUnits));
    }

    void take_header(std::string_view row) {
        const auto cells = cells_of(row);
        for (std::size_t i = 0; i < cells.size(); ++i) {
            columns_[std::string(cells[i])] = i;
        }
        for (const char* column : {"name", "x", "y", "z"}) {
            if (!columns_.contains(column)) {
                fail(std::string("there is no column \"") + column + "\"; a header name,x,y,z was needed");
            }
        }
        width_ = cells.size();
    }

    double number(const std::vector<std::string_view>& cells, const std::string& column) const {
        const std::string_view cell = cells[columns_.at(column)];
        double value = NAN;
        const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
        if (error != std::errc{} || end != cell.data() + cell.size() || !std::isfinite(value)) {
            fail("column " + column + ": \"" + std::string(cell.substr(0, 40)) +
                 "\" is no finite number; one with a decimal point was needed");
        }
        return value;
    }

    void take_row(std::string_view row) {
        const auto cells = cells_of(row);
        if (cells.size() != width_) {
            fail(std::to_string(cells.size()) + " columns where the header has " + std::to_string(width_));
        }
        TouchedRow touched{std::string(cells[columns_.at("name")]), {}, sigma_mm_};
        touched.p = mm_per_unit_ * Eigen::Vector3d(number(cells, "x"), number(cells, "y"), number(cells, "z"));
        if (columns_.contains("sigma_mm")) {
            touched.sigma_mm = number(cells, "sigma_mm");
        }
        if (!(touched.sigma_mm > 0)) {
            fail("there is no 1-sigma above 0 for \"" + touched.name +
                 "\"; give a column sigma_mm, or sigma_mm in the nominal file");
        }
        if (!seen_.insert(touched.name).second) {
            fail("\"" + touched.name + "\" stands twice");
        }
        rows_.push_back(touched);
    }

    std::string file_;
    double sigma_mm_;
    double mm_per_unit_ = 1;
    std::size_t line_ = 0, width_ = 0;
    std::map<std::string, std::size_t> columns_;
    std::set<std::string> seen_;
    std::vector<TouchedRow> rows_;
};

}  // namespace

std::vector<TouchedRow> read_touched_points(const std::filesystem::path& file, double sigma_mm) {
    return PointReader(file.string(), sigma_mm).read(read_file(file, kMaxPointBytes, "points"));
}

}  // namespace seampath
