#include "tools/table.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

#include "pipeline/files.hpp"
#include "pipeline/report_text.hpp"
#include "stages/error.hpp"

namespace seampath {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{16} << 20;
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::string_view kBlanks = " \t\r";

std::string_view trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(kBlanks);
    return first == std::string_view::npos ? std::string_view{}
                                           : text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

char separator_of(std::string_view row) {
    for (const char c : {';', ',', '\t'}) {
        if (row.find(c) != std::string_view::npos) {
            return c;
        }
    }
    return ' ';
}

std::vector<std::string_view> cells_of(std::string_view row, char separator) {
    std::vector<std::string_view> cells;
    while (true) {
        const auto end = row.find(separator);
        cells.push_back(trimmed(row.substr(0, end)));
        if (end == std::string_view::npos) {
            return cells;
        }
        row = separator == ' ' ? trimmed(row.substr(end)) : row.substr(end + 1);
    }
}

std::optional<double> number(std::string_view cell) {
    if (cell.starts_with('+') && !cell.starts_with("+-")) {
        cell.remove_prefix(1);
    }
    double value = 0;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    const bool whole = error == std::errc{} && end == cell.data() + cell.size();
    return whole ? std::optional(value) : std::nullopt;
}

/// The cell as it can stand in a message.
std::string quoted(std::string_view cell) {
    constexpr std::size_t kShown = 40;
    return '"' + valid_utf8(cell.substr(0, kShown)) + (cell.size() > kShown ? "...\"" : "\"");
}

std::string unquoted(std::string_view cell) {
    const bool quotes = cell.size() >= 2 && cell.front() == '"' && cell.back() == '"';
    return valid_utf8(quotes ? cell.substr(1, cell.size() - 2) : cell);
}

class Reader {
public:
    explicit Reader(const std::filesystem::path& file) : name_(file.string()) {}

    Table read(std::string_view text) {
        text.remove_prefix(text.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0);
        while (!text.empty()) {
            const auto end = std::min(text.find('\n'), text.size());
            ++line_;
            const auto row = trimmed(text.substr(0, end));
            if (!row.empty() && !row.starts_with('#')) {
                take(row);
            }
            text.remove_prefix(std::min(end + 1, text.size()));
        }
        if (table_.rows.empty()) {
            throw InputError("table: " + name_ +
                             " holds no row of numbers; one row a line was needed, e.g. \"0, 2.7\"; check the file");
        }
        return std::move(table_);
    }

private:
    [[noreturn]] void fail(const std::string& what) const {
        throw InputError("table: " + name_ + ":" + std::to_string(line_) + ": " + what);
    }

    void take(std::string_view row) {
        if (columns_ == 0) {
            separator_ = separator_of(row);
        }
        const auto cells = cells_of(row, separator_);
        if (columns_ == 0) {
            columns_ = cells.size();
            if (std::none_of(cells.begin(), cells.end(), [](auto cell) { return number(cell).has_value(); })) {
                std::transform(cells.begin(), cells.end(), std::back_inserter(table_.header), unquoted);
                return;
            }
        }
        if (cells.size() != columns_) {
            fail(std::to_string(cells.size()) + " columns where the rows before have " + std::to_string(columns_) +
                 "; every row must have the same; complete the row or remove it");
        }
        table_.rows.push_back(numbers(cells));
        table_.lines.push_back(line_);
    }

    std::vector<double> numbers(const std::vector<std::string_view>& cells) const {
        std::vector<double> row;
        for (std::size_t i = 0; i < cells.size(); ++i) {
            const auto value = number(cells[i]);
            if (!value || !std::isfinite(*value)) {
                fail("column " + std::to_string(i + 1) + ": " + quoted(cells[i]) +
                     " is no finite number; one with a decimal point was needed; correct the cell, or put # before a "
                     "line that is no row");
            }
            row.push_back(*value);
        }
        return row;
    }

    std::string name_;
    std::size_t line_ = 0;
    std::size_t columns_ = 0;
    char separator_ = ' ';
    Table table_;
};

}  // namespace

Table read_table(const std::filesystem::path& file) {
    return Reader(file).read(read_file(file, kMaxBytes, "table"));
}

}  // namespace seampath
