#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <liblzf/lzf.h>

#include "stages/read/columns.hpp"
#include "stages/read/formats.hpp"
#include "stages/read/rows.hpp"

namespace seampath {
namespace {

constexpr std::size_t kHeaderLimit = 64 * 1024;
constexpr std::array<std::string_view, 6> kWanted{"x", "y", "z", "normal_x", "normal_y", "normal_z"};
constexpr std::array<double, 7> kDefaultViewpoint{0, 0, 0, 1, 0, 0, 0};
constexpr std::string_view kExportAgain = "; export or copy the file again";

struct PcdField {
    std::string_view name;
    std::uint64_t size = 4;
    char type = 'F';
    std::uint64_t count = 1;
    Scalar scalar = Scalar::f32;
    std::size_t offset = 0;  ///< within a record
};

struct PcdHeader {
    std::vector<PcdField> fields;
    std::optional<std::uint64_t> width;
    std::optional<std::uint64_t> height;
    std::optional<std::uint64_t> points;
    std::array<double, 7> viewpoint = kDefaultViewpoint;
    std::string_view encoding;
    std::size_t record_size = 0;
    std::size_t data = 0;  ///< first byte behind the header
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
                    PcdHeader& header, Set set) {
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

void take_viewpoint(const Source& source, std::size_t at, std::string_view line, PcdHeader& header) {
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

void take_line(const Source& source, std::size_t at, std::string_view keyword, std::string_view line,
               PcdHeader& header) {
    if (keyword == "FIELDS" || keyword == "COLUMNS") {
        header.fields.clear();
        for (std::string_view token = next_token(line); !token.empty(); token = next_token(line)) {
            header.fields.emplace_back().name = token;
        }
    } else if (keyword == "SIZE") {
        take_per_field(source, at, keyword, line, header,
                       [&](PcdField& f, std::string_view token) { f.size = take_count(source, at, keyword, token); });
    } else if (keyword == "TYPE") {
        take_per_field(source, at, keyword, line, header,
                       [&](PcdField& f, std::string_view token) { f.type = token.size() == 1 ? token[0] : '?'; });
    } else if (keyword == "COUNT") {
        take_per_field(source, at, keyword, line, header,
                       [&](PcdField& f, std::string_view token) { f.count = take_count(source, at, keyword, token); });
    } else if (keyword == "WIDTH") {
        header.width = take_count(source, at, keyword, next_token(line));
    } else if (keyword == "HEIGHT") {
        header.height = take_count(source, at, keyword, next_token(line));
    } else if (keyword == "POINTS") {
        header.points = take_count(source, at, keyword, next_token(line));
    } else if (keyword == "VIEWPOINT") {
        take_viewpoint(source, at, line, header);
    } else if (keyword == "DATA") {
        header.encoding = next_token(line);
    } else if (keyword != "VERSION") {
        fail_at_line(source, at,
                     in_quotes(keyword) + " is no word of a PCD header; is it another format under this name?");
    }
}

std::optional<Scalar> scalar_of(const PcdField& field) {
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

void lay_out_record(const Source& source, PcdHeader& header) {
    for (PcdField& field : header.fields) {
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
        const auto is_axis = [&](const PcdField& f) { return f.name == kWanted[i] && f.count == 1; };
        const auto found = std::count_if(header.fields.begin(), header.fields.end(), is_axis);
        if (found != 1) {
            fail(source, "FIELDS has " + std::to_string(found) + " fields '" + std::string(kWanted[i]) +
                             "' of COUNT 1; a scan needs one x, one y and one z");
        }
    }
}

void check_counts(const Source& source, PcdHeader& header) {
    if (!header.width && !header.points) {
        fail(source, "the PCD header has neither WIDTH nor POINTS" + std::string(kExportAgain));
    }
    const std::uint64_t height = header.height.value_or(1);
    const std::uint64_t width = header.width.value_or(*header.points);
    const std::uint64_t points = header.points.value_or(width);
    const bool overflows = height > 0 && width > std::numeric_limits<std::uint64_t>::max() / height;
    if (overflows || width * height != points) {
        fail(source, "WIDTH " + std::to_string(width) + " times HEIGHT " + std::to_string(height) + " is not POINTS " +
                         std::to_string(points) + std::string(kExportAgain));
    }
    header.width = width;
    header.height = height;
    header.points = points;
}

PcdHeader read_header(const Source& source) {
    PcdHeader header;
    const std::string_view head = source.bytes.substr(0, kHeaderLimit);
    std::size_t next = 0;
    while (next < head.size() && header.encoding.empty()) {
        const std::size_t at = next;
        std::string_view line = next_line(head, next);
        const std::string_view keyword = next_token(line);
        if (!keyword.empty() && keyword.front() != '#') {
            take_line(source, at, keyword, line, header);
        }
    }
    if (header.encoding.empty()) {
        fail_at_byte(
            source, head.size(),
            "the PCD header does not end; expected a DATA line within its first 64 KiB" + std::string(kExportAgain));
    }
    header.data = next;
    lay_out_record(source, header);
    check_counts(source, header);
    return header;
}

const PcdField* find_field(const PcdHeader& header, std::string_view name) {
    const auto at = std::find_if(header.fields.begin(), header.fields.end(),
                                 [&](const PcdField& f) { return f.name == name && f.count == 1; });
    return at == header.fields.end() ? nullptr : &*at;
}

bool has_normals(const PcdHeader& header) {
    return std::all_of(kWanted.begin() + 3, kWanted.end(),
                       [&](auto name) { return find_field(header, name) != nullptr; });
}

void decode_ascii(const Source& source, const PcdHeader& header, bool raster, Cloud& cloud) {
    const Rows rows = find_rows(source, header.data);
    if (rows.count != *header.points) {
        fail_at_line(source, source.bytes.size(),
                     "the file ends after " + std::to_string(rows.count) + " lines of data; the header promises " +
                         std::to_string(*header.points) + std::string(kExportAgain));
    }
    RowLayout layout;
    const bool normals = has_normals(header);
    for (const PcdField& field : header.fields) {
        const auto wanted = std::find(kWanted.begin(), kWanted.end(), field.name);
        int slot = wanted == kWanted.end() || find_field(header, field.name) != &field
                       ? -1
                       : static_cast<int>(wanted - kWanted.begin());
        slot = slot >= 3 && !normals ? -1 : slot;
        layout.items.insert(layout.items.end(), static_cast<std::size_t>(field.count), RowItem{slot, false});
    }
    decode_rows(cloud, source, rows, 0, rows.count, layout, raster);
}

/// Columns of records that stand one behind the other, or (`by_field`) of fields that do.
std::array<Column, 6> columns_of(const PcdHeader& header, const char* data, bool by_field) {
    std::array<Column, 6> columns;
    for (std::size_t i = 0; i < kWanted.size(); ++i) {
        if (const PcdField* field = find_field(header, kWanted[i])) {
            const char* first = data + field->offset * (by_field ? static_cast<std::size_t>(*header.points) : 1);
            const std::size_t stride = by_field ? static_cast<std::size_t>(field->size) : header.record_size;
            columns[i] = {first, stride, field->scalar, false};
        }
    }
    return columns;
}

void decode_records(const PcdHeader& header, const char* data, bool by_field, bool raster, Cloud& cloud) {
    const auto c = columns_of(header, data, by_field);
    std::optional<std::array<Column, 3>> normal;
    if (has_normals(header)) {
        normal = {c[3], c[4], c[5]};
    }
    decode_columns(cloud, {c[0], c[1], c[2]}, normal, static_cast<std::size_t>(*header.points), raster);
}

/// Some writers fill the file up to a whole page with zeros; anything else behind the data is an error.
void check_rest(const Source& source, std::size_t end) {
    const std::size_t other = source.bytes.find_first_not_of('\0', end);
    if (other != std::string_view::npos) {
        fail_at_byte(source, other,
                     std::to_string(source.bytes.size() - end) +
                         " bytes follow the last point; expected the end of the file" + std::string(kExportAgain));
    }
}

void decode_binary(const Source& source, const PcdHeader& header, bool raster, Cloud& cloud) {
    const std::size_t left = source.bytes.size() - header.data;
    if (*header.points > left / header.record_size) {
        fail_at_byte(source, header.data,
                     "the header promises " + std::to_string(*header.points) + " points of " +
                         std::to_string(header.record_size) + " bytes, but only " + std::to_string(left) +
                         " bytes are left" + std::string(kExportAgain));
    }
    check_rest(source, header.data + static_cast<std::size_t>(*header.points) * header.record_size);
    decode_records(header, source.bytes.data() + header.data, false, raster, cloud);
}

/// How many bytes an LZF stream unpacks to, found without unpacking it: a control byte below 32 is followed by one more
/// literal bytes than its value; above, its top three bits (7: plus the next byte) and 2 are the length of a copy, with
/// one more byte of distance.
std::size_t unpacked_size(std::string_view packed) {
    std::size_t size = 0;
    std::size_t at = 0;
    while (at < packed.size()) {
        const std::size_t control = static_cast<unsigned char>(packed[at++]);
        if (control < 32) {
            size += control + 1;
            at += control + 1;
            continue;
        }
        std::size_t length = control >> 5;
        if (length == 7 && at < packed.size()) {
            length += static_cast<unsigned char>(packed[at++]);
        }
        size += length + 2;
        ++at;
    }
    return size;
}

void decode_compressed(const Source& source, const PcdHeader& header, bool raster, Cloud& cloud) {
    const std::size_t left = source.bytes.size() - header.data;
    if (left < 8) {
        fail_at_byte(source, header.data,
                     "the file ends before the two sizes of its compressed data" + std::string(kExportAgain));
    }
    const char* sizes = source.bytes.data() + header.data;
    const auto packed_size = static_cast<std::size_t>(load(sizes, Scalar::u32, false));
    const auto size = static_cast<std::size_t>(load(sizes + 4, Scalar::u32, false));
    if (packed_size > left - 8) {
        fail_at_byte(source, header.data,
                     "the file holds " + std::to_string(left - 8) + " of " + std::to_string(packed_size) +
                         " bytes of compressed data" + std::string(kExportAgain));
    }
    if (size / header.record_size != *header.points || size % header.record_size != 0) {
        fail_at_byte(source, header.data + 4,
                     "the compressed data is of " + std::to_string(size) + " bytes; the header promises " +
                         std::to_string(*header.points) + " points of " + std::to_string(header.record_size) +
                         " bytes" + std::string(kExportAgain));
    }
    check_rest(source, header.data + 8 + packed_size);
    const std::string_view packed(sizes + 8, packed_size);
    const bool promised = unpacked_size(packed) == size;
    const auto data = std::make_unique_for_overwrite<char[]>(promised ? size : 0);
    if (!promised || (size > 0 && lzf_decompress(packed.data(), static_cast<unsigned>(packed_size), data.get(),
                                                 static_cast<unsigned>(size)) != size)) {
        fail_at_byte(source, header.data + 8,
                     "the compressed data does not unpack to the " + std::to_string(size) +
                         " bytes promised; it is damaged" + std::string(kExportAgain));
    }
    decode_records(header, data.get(), true, raster, cloud);
}

}  // namespace

Cloud read_pcd(const Source& source) {
    const PcdHeader header = read_header(source);
    constexpr std::uint64_t kRasterLimit = std::numeric_limits<std::uint32_t>::max();
    const bool raster = *header.width > 1 && *header.height > 1 && *header.points <= kRasterLimit;
    Cloud cloud;
    cloud.format = "pcd " + std::string(header.encoding);
    if (header.encoding == "ascii") {
        decode_ascii(source, header, raster, cloud);
    } else if (header.encoding == "binary") {
        decode_binary(source, header, raster, cloud);
    } else if (header.encoding == "binary_compressed") {
        decode_compressed(source, header, raster, cloud);
    } else {
        fail(source, "DATA is " + in_quotes(header.encoding) + "; expected ascii, binary or binary_compressed");
    }
    if (raster) {
        cloud.width = static_cast<std::uint32_t>(*header.width);
        cloud.height = static_cast<std::uint32_t>(*header.height);
    }
    if (raster || header.viewpoint != kDefaultViewpoint) {
        cloud.sensor = Eigen::Vector3d(header.viewpoint[0], header.viewpoint[1], header.viewpoint[2]);
    }
    return cloud;
}

}  // namespace seampath
