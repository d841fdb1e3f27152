#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include <liblzf/lzf.h>

#include "stages/read/columns.hpp"
#include "stages/read/formats.hpp"
#include "stages/read/pcd_header.hpp"
#include "stages/read/rows.hpp"

namespace seampath {
namespace pcd {
namespace {

void decode_ascii(const Source& source, const Header& header, bool raster, Cloud& cloud) {
    const Rows rows = find_rows(source, header.data);
    if (rows.count != header.points) {
        fail_at_line(source, source.bytes.size(),
                     "the file ends after " + std::to_string(rows.count) + " lines of data; the header promises " +
                         std::to_string(header.points) + std::string(kExportAgain));
    }
    RowLayout layout;
    const bool normals = has_normals(header);
    for (const Field& field : header.fields) {
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
std::array<Column, 6> columns_of(const Header& header, const char* data, bool by_field) {
    std::array<Column, 6> columns;
    for (std::size_t i = 0; i < kWanted.size(); ++i) {
        if (const Field* field = find_field(header, kWanted[i])) {
            const char* first = data + field->offset * (by_field ? static_cast<std::size_t>(header.points) : 1);
            const std::size_t stride = by_field ? static_cast<std::size_t>(field->size) : header.record_size;
            columns[i] = {first, stride, field->scalar, false};
        }
    }
    return columns;
}

void decode_records(const Header& header, const char* data, bool by_field, bool raster, Cloud& cloud) {
    const auto c = columns_of(header, data, by_field);
    std::optional<std::array<Column, 3>> normal;
    if (has_normals(header)) {
        normal = {c[3], c[4], c[5]};
    }
    decode_columns(cloud, {c[0], c[1], c[2]}, normal, static_cast<std::size_t>(header.points), raster);
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

void decode_binary(const Source& source, const Header& header, bool raster, Cloud& cloud) {
    const std::size_t left = source.bytes.size() - header.data;
    if (header.points > left / header.record_size) {
        fail_at_byte(source, header.data,
                     "the header promises " + std::to_string(header.points) + " points of " +
                         std::to_string(header.record_size) + " bytes, but only " + std::to_string(left) +
                         " bytes are left" + std::string(kExportAgain));
    }
    check_rest(source, header.data + static_cast<std::size_t>(header.points) * header.record_size);
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

void decode_compressed(const Source& source, const Header& header, bool raster, Cloud& cloud) {
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
    if (size / header.record_size != header.points || size % header.record_size != 0) {
        fail_at_byte(source, header.data + 4,
                     "the compressed data is of " + std::to_string(size) + " bytes; the header promises " +
                         std::to_string(header.points) + " points of " + std::to_string(header.record_size) + " bytes" +
                         std::string(kExportAgain));
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
}  // namespace pcd

Cloud read_pcd(const Source& source) {
    const pcd::Header header = pcd::read_header(source);
    constexpr std::uint64_t kRasterLimit = std::numeric_limits<std::uint32_t>::max();
    const bool raster = header.width > 1 && header.height > 1 && header.points <= kRasterLimit;
    Cloud cloud;
    cloud.format = "pcd " + std::string(header.encoding);
    if (header.encoding == "ascii") {
        pcd::decode_ascii(source, header, raster, cloud);
    } else if (header.encoding == "binary") {
        pcd::decode_binary(source, header, raster, cloud);
    } else if (header.encoding == "binary_compressed") {
        pcd::decode_compressed(source, header, raster, cloud);
    } else {
        fail(source, "DATA is " + in_quotes(header.encoding) + "; expected ascii, binary or binary_compressed");
    }
    if (raster) {
        cloud.width = static_cast<std::uint32_t>(header.width);
        cloud.height = static_cast<std::uint32_t>(header.height);
    }
    if (raster || header.viewpoint != pcd::kDefaultViewpoint) {
        cloud.sensor = Eigen::Vector3d(header.viewpoint[0], header.viewpoint[1], header.viewpoint[2]);
    }
    return cloud;
}

}  // namespace seampath
