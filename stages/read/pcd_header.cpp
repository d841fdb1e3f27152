#include "stages/read/pcd_header.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "stages/read/cloud.hpp"

namespace seampath::pcd {
namespace {

constexpr std::size_t kHeaderLimit = 65536;

/// The counts as they stand in the header, which may leave some out.
struct Counts {
    std::optional<std::uint64_t> width;
    std::optional<std::uint64_t> height;
    std::optional<std::uint64_t> points;
};

std::uint64_t take_count(const Source& source, std::size_t at, std::string_view keyword, std::string_view token) {
    const auto value = parse_integer<std::uint64_t>(token);
    if (!value) {
        fail_at_line(source, at,
                     std::string(keyword) + " is " + in_quotes(token) + "; expected a whole number of 0 or more");
    }
    return *value;
}

/// One word per field, as SIZE, TYPE and COUNT hold.
template <class Set>
void take_per_field(const Source& source, std::size_t at, std::string_view keyword, std::string_view line,
                    Header& header, Set set) {
    std::size_t taken = 0;
    for (std::string_view token = next_token(line); !token.empty(); token = next_token(line)) {
        if (taken < header.fields.size()) {
            set(header.fields[taken], token);
        }
        ++taken;
    }
    if (taken != header.fields.size()) {
        fail_at_line(source, at,
                     std::string(keyword) + " has " + std::to_string(taken) + " values for the " +
                         std::to_string(header.fields.size()) +
                         " fields before it; expected one for each name in FIELDS");
    }
}

void take_viewpoint(const Source& source, std::size_t at, std::string_view line, Header& header) {
    for (double& value : header.viewpoint) {
        const std::string_view token = next_token(line);
        const auto number = parse_number(token);
        if (!number || !(std::abs(*number) <= kCoordinateLimit)) {
            fail_at_line(source, at,
                         "VIEWPOINT holds " + in_quotes(token) + "; expected 7 finite numbers: tx ty tz qw qx qy qz");
        }
        value = *number;
    }
}

void take_line(const Source& source, std::size_t at, std::string_view keyword, std::string_view line, Header& header,
               Counts& counts) {
    if (keyword == "FIELDS" || keyword == "COLUMNS") {
        header.fields.clear();
        for (std::string_view token = next_token(line); !token.empty(); token = next_token(line)) {
            header.fields.emplace_back().name = token;
        }
    } else if (keyword == "SIZE") {
        take_per_field(source, at, keyword, line, header,
                       [&](Field& f, std::string_view token) { f.size = take_count(source, at, keyword, token); });
    } else if (keyword == "TYPE") {
        take_per_field(source, at, keyword, line, header,
                       [&](Field& f, std::string_view token) { f.type = token.size() == 1 ? token[0] : '?'; });
    } else if (keyword == "COUNT") {
        take_per_field(source, at, keyword, line, header,
                       [&](Field& f, std::string_view token) { f.count = take_count(source, at, keyword, token); });
    } else if (keyword == "WIDTH") {
        counts.width = take_count(source, at, keyword, next_token(line));
    } else if (keyword == "HEIGHT") {
        counts.height = take_count(source, at, keyword, next_token(line));
    } else if (keyword == "POINTS") {
        counts.points = take_count(source, at, keyword, next_token(line));
    } else if (keyword == "VIEWPOINT") {
        take_viewpoint(source, at, line, header);
    } else if (keyword == "DATA") {
        header.encoding = next_token(line);
    } else if (keyword != "VERSION") {
        fail_at_line(source, at,
                     in_quotes(keyword) + " is no word of a PCD header; is it another format under this name?");
    }
}

std::optional<Scalar> scalar_of(const Field& field) {
    struct Row {
        char type;
        std::uint64_t size;
        Scalar scalar;
    };
    constexpr std::array<Row, 10> kRows{{{'I', 1, Scalar::i8},
                                         {'U', 1, Scalar::u8},
                                         {'I', 2, Scalar::i16},
                                         {'U', 2, Scalar::u16},
                                         {'I', 4, Scalar::i32},
                                         {'U', 4, Scalar::u32},
                                         {'I', 8, Scalar::i64},
                                         {'U', 8, Scalar::u64},
                                         {'F', 4, Scalar::f32},
                                         {'F', 8, Scalar::f64}}};
    for (const Row& row : kRows) {
        if (row.type == field.type && row.size == field.size) {
            return row.scalar;
        }
    }
    return std::nullopt;
}

void lay_out_record(const Source& source, Header& header) {
    for (Field& field : header.fields) {
        const auto scalar = scalar_of(field);
        if (!scalar) {
            fail(source, "field " + in_quotes(field.name) + " has TYPE " + in_quotes({&field.type, 1}) + " and SIZE " +
                             std::to_string(field.size) + "; expected F with 4 or 8, or I or U with 1, 2, 4 or 8");
        }
        if (field.count < 1 || field.count > kHeaderLimit) {
            fail(source, "field " + in_quotes(field.name) + " has COUNT " + std::to_string(field.count) +
                             "; expected 1 to " + std::to_string(kHeaderLimit));
        }
        field.scalar = *scalar;
        field.offset = header.record_size;
        header.record_size += static_cast<std::size_t>(field.count * field.size);
    }
    for (std::size_t i = 0; i < 3; ++i) {
        const auto is_axis = [&](const Field& f) { return f.name == kWanted[i] && f.count == 1; };
        const auto found = std::count_if(header.fields.begin(), header.fields.end(), is_axis);
        if (found != 1) {
            fail(source, "FIELDS has " + std::to_string(found) + " fields '" + std::string(kWanted[i]) +
                             "' of COUNT 1; a scan needs one x, one y and one z");
        }
    }
}

void check_counts(const Source& source, const Counts& counts, Header& header) {
    if (!counts.width && !counts.points) {
        fail(source, "the PCD header has neither WIDTH nor POINTS" + std::string(kExportAgain));
    }
    header.height = counts.height.value_or(1);
    header.width = counts.width ? *counts.width : *counts.points;
    header.points = counts.points.value_or(header.width * header.height);
    const bool overflows =
        header.height > 0 && header.width > std::numeric_limits<std::uint64_t>::max() / header.height;
    if (overflows || header.width * header.height != header.points) {
        fail(source, "WIDTH " + std::to_string(header.width) + " times HEIGHT " + std::to_string(header.height) +
                         " is not POINTS " + std::to_string(header.points) + std::string(kExportAgain));
    }
}

}  // namespace

Header read_header(const Source& source) {
    Header header;
    Counts counts;
    const std::string_view head = source.bytes.substr(0, kHeaderLimit);
    std::size_t next = 0;
    while (next < head.size() && header.encoding.empty()) {
        const std::size_t at = next;
        std::string_view line = next_line(head, next);
        const std::string_view keyword = next_token(line);
        if (!keyword.empty() && keyword.front() != '#') {
            take_line(source, at, keyword, line, header, counts);
        }
    }
    if (header.encoding.empty()) {
        fail_at_byte(
            source, head.size(),
            "the PCD header does not end; expected a DATA line within its first 64 KiB" + std::string(kExportAgain));
    }
    header.data = next;
    lay_out_record(source, header);
    check_counts(source, counts, header);
    return header;
}

const Field* find_field(const Header& header, std::string_view name) {
    const auto at = std::find_if(header.fields.begin(), header.fields.end(),
                                 [&](const Field& f) { return f.name == name && f.count == 1; });
    return at == header.fields.end() ? nullptr : &*at;
}

bool has_normals(const Header& header) {
    return std::all_of(kWanted.begin() + 3, kWanted.end(),
                       [&](auto name) { return find_field(header, name) != nullptr; });
}

}  // namespace seampath::pcd
