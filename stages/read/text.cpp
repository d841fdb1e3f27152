#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "stages/read/formats.hpp"
#include "stages/read/rows.hpp"

namespace seampath {
namespace {

constexpr std::array<std::string_view, 6> kWanted{"x", "y", "z", "nx", "ny", "nz"};
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

char separator_of(std::string_view row) {
    for (const char c : {';', ','}) {
        if (row.find(c) != std::string_view::npos) {
            return c;
        }
    }
    return ' ';
}

std::vector<std::string_view> fields_of(std::string_view row, char separator) {
    std::vector<std::string_view> fields;
    while (!row.empty()) {
        fields.push_back(next_field(row, separator));
    }
    return fields;
}

/// A column's name in small letters, without quotation marks.
std::string column_name(std::string_view field) {
    std::string name;
    for (const char c : field) {
        if (c != '"') {
            name += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
        }
    }
    return name;
}

bool is_data(const std::vector<std::string_view>& fields) {
    return std::all_of(fields.begin(),
                       fields.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(3, fields.size())),
                       [](std::string_view field) { return parse_number(field).has_value(); });
}

RowLayout layout_of_header(const Source& source, std::size_t at, const std::vector<std::string_view>& fields) {
    RowLayout layout;
    std::array<int, 6> found{};
    for (const std::string_view field : fields) {
        const auto wanted = std::find(kWanted.begin(), kWanted.end(), column_name(field));
        const int slot = wanted == kWanted.end() ? -1 : static_cast<int>(wanted - kWanted.begin());
        layout.items.push_back({slot, false});
        if (slot >= 0) {
            ++found[static_cast<std::size_t>(slot)];
        }
    }
    if (!std::all_of(found.begin(), found.begin() + 3, [](int n) { return n == 1; })) {
        fail_at_line(source, at,
                     "neither numbers (with decimal points) nor a header that names one column each x, y and z; give "
                     "it these names, or put # "
                     "before the line so that the first three columns are taken");
    }
    if (!std::all_of(found.begin() + 3, found.end(), [](int n) { return n == 1; })) {
        for (RowItem& item : layout.items) {
            item.slot = item.slot < 3 ? item.slot : -1;
        }
    }
    return layout;
}

bool is_unit(double x, double y, double z) {
    constexpr double kRounding = 0.01;
    return std::abs(std::sqrt(x * x + y * y + z * z) - 1) <= kRounding;
}

RowLayout layout_without_header(const Source& source, const Rows& rows, std::size_t columns, char separator) {
    RowLayout layout;
    layout.separator = separator;
    for (std::size_t i = 0; i < columns; ++i) {
        layout.items.push_back({i < 3 || columns == 6 ? static_cast<int>(i) : -1, false});
    }
    const auto samples = sample_rows(source, rows, 0, rows.count, layout);
    const bool normals =
        std::all_of(samples.begin(), samples.end(), [](const RowNumbers& n) { return is_unit(n[3], n[4], n[5]); });
    if (columns == 6 && (!normals || samples.empty())) {
        std::for_each(layout.items.begin() + 3, layout.items.end(), [](RowItem& item) { item.slot = -1; });
    }
    return layout;
}

void check_is_text(const Source& source) {
    const std::size_t nul = source.bytes.find('\0');
    if (nul != std::string_view::npos) {
        fail_at_byte(source, nul,
                     "a zero byte; expected plain text in ASCII or UTF-8; save the file so, or name its format "
                     "by its extension");
    }
}

}  // namespace

Cloud read_text(const Source& source) {
    check_is_text(source);
    const std::size_t begin = source.bytes.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
    std::size_t next = begin;
    const std::string_view row = next_row(source.bytes, next);
    const auto at = static_cast<std::size_t>(row.empty() ? 0 : row.data() - source.bytes.data());
    const char separator = separator_of(row);
    const auto fields = fields_of(row, separator);
    if (!row.empty() && fields.size() < 3) {
        fail_at_line(source, at,
                     in_quotes(row) + " has " + std::to_string(fields.size()) +
                         " columns; expected at least 3: x, y, z; remove the line or export the scan again");
    }
    const Rows rows = find_rows(source, begin);
    const bool header = !is_data(fields);
    RowLayout layout =
        header ? layout_of_header(source, at, fields) : layout_without_header(source, rows, fields.size(), separator);
    layout.separator = separator;
    Cloud cloud;
    cloud.format = "text";
    const std::size_t first = header ? 1 : 0;
    decode_rows(cloud, source, rows, first, rows.count - first, layout, false);
    const auto is_normal = [](const Eigen::Vector3f& n) {
        return is_unit(static_cast<double>(n.x()), static_cast<double>(n.y()), static_cast<double>(n.z()));
    };
    if (!header && !std::all_of(cloud.normals.begin(), cloud.normals.end(), is_normal)) {
        cloud.normals = {};
    }
    return cloud;
}

}  // namespace seampath
