#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "stages/read/columns.hpp"
#include "stages/read/formats.hpp"
#include "stages/read/ply_header.hpp"
#include "stages/read/rows.hpp"

namespace seampath {
namespace ply {
namespace {

/// Slot 0..5 of a vertex property, or -1; normals only where all three are there.
std::vector<int> slots_of(const Element& vertex) {
    std::vector<int> slots;
    for (const Property& property : vertex.properties) {
        const auto wanted = std::find(kWanted.begin(), kWanted.end(), property.name);
        const bool taken = wanted != kWanted.end() && !property.length;
        slots.push_back(taken ? static_cast<int>(wanted - kWanted.begin()) : -1);
    }
    if (std::count_if(slots.begin(), slots.end(), [](int s) { return s >= 3; }) != 3) {
        std::replace_if(
            slots.begin(), slots.end(), [](int s) { return s >= 3; }, -1);
    }
    return slots;
}

void decode_ascii(const Source& source, const Header& header, Cloud& cloud) {
    const Rows rows = find_rows(source, header.data);
    std::size_t expected = 0;
    std::size_t first = 0;
    for (std::size_t e = 0; e < header.elements.size(); ++e) {
        const Element& element = header.elements[e];
        if (e == header.vertex) {
            first = expected;
        }
        if (element.properties.empty()) {
            continue;
        }
        if (element.count > rows.count - expected) {
            fail_at_line(source, source.bytes.size(),
                         "the file ends after " + std::to_string(rows.count - expected) + " of " +
                             std::to_string(element.count) + " lines of element " + in_quotes(element.name) +
                             std::string(kExportAgain));
        }
        expected += static_cast<std::size_t>(element.count);
    }
    if (rows.count > expected) {
        fail(source, std::to_string(rows.count - expected) + " lines follow the last element; the header promises " +
                         std::to_string(expected) + " in all" + std::string(kExportAgain));
    }
    const Element& vertex = header.elements[header.vertex];
    RowLayout layout;
    const auto slots = slots_of(vertex);
    for (std::size_t i = 0; i < slots.size(); ++i) {
        layout.items.push_back({slots[i], vertex.properties[i].length.has_value()});
    }
    decode_rows(cloud, source, rows, first, static_cast<std::size_t>(vertex.count), layout, false);
}

/// Walks over the records of one binary element. Every step is checked against the bytes that are left.
class Walker {
public:
    Walker(const Source& source, const Element& element, std::size_t offset, bool swap)
        : source_(source), element_(element), offset_(offset), swap_(swap) {
        for (const Property& p : element.properties) {
            min_record_ += size_of(p.length.value_or(p.type));
            has_list_ = has_list_ || p.length;
        }
        const std::size_t left = source.bytes.size() - offset;
        if (min_record_ > 0 && element.count > left / min_record_) {
            fail_at_byte(source, offset,
                         "element " + in_quotes(element.name) + " promises " + std::to_string(element.count) +
                             " records of " + (has_list_ ? "at least " : "") + std::to_string(min_record_) +
                             " bytes, but only " + std::to_string(left) + " bytes are left" +
                             std::string(kExportAgain));
        }
    }

    bool has_list() const { return has_list_; }
    std::size_t record_size() const { return min_record_; }

    /// Goes to the end of the element; `visit(record, property, at)` sees each scalar of an element with lists.
    template <class Visit>
    std::size_t walk(Visit visit) {
        if (!has_list_) {
            return offset_ + (min_record_ == 0 ? 0 : static_cast<std::size_t>(element_.count) * min_record_);
        }
        for (record_ = 0; record_ < element_.count; ++record_) {
            for (std::size_t p = 0; p < element_.properties.size(); ++p) {
                const Property& property = element_.properties[p];
                if (property.length) {
                    step_over_list(property);
                } else {
                    visit(record_, p, take(size_of(property.type)));
                }
            }
        }
        return offset_;
    }

private:
    const char* take(std::size_t bytes) {
        if (bytes > source_.bytes.size() - offset_) {
            fail_at_byte(source_, offset_,
                         "the file ends within record " + std::to_string(record_) + " of " +
                             std::to_string(element_.count) + " of element " + in_quotes(element_.name) +
                             std::string(kExportAgain));
        }
        offset_ += bytes;
        return source_.bytes.data() + offset_ - bytes;
    }

    void step_over_list(const Property& property) {
        const std::size_t at = offset_;
        const double length = load(take(size_of(*property.length)), *property.length, swap_);
        if (length < 0 || length > std::numeric_limits<std::uint32_t>::max()) {
            fail_at_byte(source_, at,
                         "list " + in_quotes(property.name) + " of record " + std::to_string(record_) +
                             " has a length of " + std::to_string(length) + "; expected 0 to 4294967295");
        }
        take(static_cast<std::size_t>(length) * size_of(property.type));
    }

    const Source& source_;
    const Element& element_;
    std::size_t offset_;
    bool swap_;
    std::size_t min_record_ = 0;
    bool has_list_ = false;
    std::uint64_t record_ = 0;
};

constexpr auto kNoVisit = [](std::uint64_t, std::size_t, const char*) {};

/// Where the wanted numbers of a binary vertex element are. `dense` holds them where records differ in length.
struct VertexColumns {
    std::array<Column, 6> columns;
    std::vector<double> dense;
};

/// Copies the wanted numbers out of records that hold lists; gives the end of the element.
std::size_t collect_vertices(Walker& walker, const Element& vertex, bool swap, VertexColumns& out) {
    constexpr std::size_t kSlots = 6;
    out.dense.resize(static_cast<std::size_t>(vertex.count) * kSlots);
    for (std::size_t i = 0; i < kSlots; ++i) {
        out.columns[i] = {reinterpret_cast<const char*>(out.dense.data() + i), kSlots * sizeof(double), Scalar::f64,
                          false};
    }
    const auto slots = slots_of(vertex);
    return walker.walk([&](std::uint64_t record, std::size_t p, const char* at) {
        if (slots[p] >= 0) {
            const std::size_t to = static_cast<std::size_t>(record) * kSlots + static_cast<std::size_t>(slots[p]);
            out.dense[to] = load(at, vertex.properties[p].type, swap);
        }
    });
}

/// Finds the wanted numbers in the file itself, or collects them; gives the end of the element.
std::size_t locate_vertices(const Source& source, const Element& vertex, std::size_t offset, bool swap,
                            VertexColumns& out) {
    Walker walker(source, vertex, offset, swap);
    if (vertex.count == 0) {
        return offset;
    }
    if (walker.has_list()) {
        return collect_vertices(walker, vertex, swap, out);
    }
    const auto slots = slots_of(vertex);
    const char* at = source.bytes.data() + offset;
    for (std::size_t p = 0; p < slots.size(); ++p) {
        const Scalar type = vertex.properties[p].type;
        if (slots[p] >= 0) {
            out.columns[static_cast<std::size_t>(slots[p])] = {at, walker.record_size(), type, swap};
        }
        at += size_of(type);
    }
    return walker.walk(kNoVisit);
}

void decode_binary(const Source& source, const Header& header, Cloud& cloud) {
    const bool swap = header.encoding == "binary_big_endian";
    VertexColumns vertices;
    std::size_t offset = header.data;
    for (std::size_t e = 0; e < header.elements.size(); ++e) {
        const Element& element = header.elements[e];
        offset = e == header.vertex ? locate_vertices(source, element, offset, swap, vertices)
                                    : Walker(source, element, offset, swap).walk(kNoVisit);
    }
    if (offset != source.bytes.size()) {
        fail_at_byte(source, offset,
                     std::to_string(source.bytes.size() - offset) +
                         " bytes follow the last element; expected the end of the file" + std::string(kExportAgain));
    }
    const auto& c = vertices.columns;
    const Element& vertex = header.elements[header.vertex];
    const auto slots = slots_of(vertex);
    std::optional<std::array<Column, 3>> normal;
    if (std::find(slots.begin(), slots.end(), 3) != slots.end()) {
        normal = {c[3], c[4], c[5]};
    }
    decode_columns(cloud, {c[0], c[1], c[2]}, normal, static_cast<std::size_t>(vertex.count), false);
}

}  // namespace
}  // namespace ply

Cloud read_ply(const Source& source) {
    const ply::Header header = ply::read_header(source);
    Cloud cloud;
    cloud.format = "ply " + std::string(header.encoding);
    if (header.encoding == "ascii") {
        ply::decode_ascii(source, header, cloud);
    } else {
        ply::decode_binary(source, header, cloud);
    }
    return cloud;
}

}  // namespace seampath
