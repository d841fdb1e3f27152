#include "stages/read/ply_header.hpp"

#include <algorithm>
#include <string>

namespace seampath::ply {
namespace {

constexpr std::size_t kHeaderLimit = 65536;

std::optional<Scalar> scalar_named(std::string_view name) {
    constexpr std::array<std::array<std::string_view, 2>, 10> kNames{{{"char", "int8"},
                                                                      {"uchar", "uint8"},
                                                                      {"short", "int16"},
                                                                      {"ushort", "uint16"},
                                                                      {"int", "int32"},
                                                                      {"uint", "uint32"},
                                                                      {"int64", "int64"},
                                                                      {"uint64", "uint64"},
                                                                      {"float", "float32"},
                                                                      {"double", "float64"}}};
    for (std::size_t i = 0; i < kNames.size(); ++i) {
        if (name == kNames[i][0] || name == kNames[i][1]) {
            return static_cast<Scalar>(i);
        }
    }
    return std::nullopt;
}

Scalar take_type(const Source& source, std::size_t at, std::string_view& line) {
    const std::string_view token = next_token(line);
    const auto type = scalar_named(token);
    if (!type) {
        fail_at_line(source, at, in_quotes(token) + " is no PLY type; expected one like float, double, uchar or int");
    }
    return *type;
}

void take_property(const Source& source, std::size_t at, std::string_view line, Header& header) {
    if (header.elements.empty()) {
        fail_at_line(source, at, "a property before any element; expected 'element vertex <count>' first");
    }
    Property property;
    std::string_view rest = line;
    if (next_token(rest) == "list") {
        property.length = take_type(source, at, rest);
        if (*property.length == Scalar::f32 || *property.length == Scalar::f64) {
            fail_at_line(source, at, "a list whose length is a floating-point number; expected an integer type");
        }
        line = rest;
    }
    property.type = take_type(source, at, line);
    property.name = next_token(line);
    if (property.name.empty()) {
        fail_at_line(source, at, "a property without a name; expected 'property <type> <name>'");
    }
    auto& properties = header.elements.back().properties;
    if (std::any_of(properties.begin(), properties.end(), [&](const Property& p) { return p.name == property.name; })) {
        fail_at_line(source, at, "property " + in_quotes(property.name) + " stands twice in its element");
    }
    properties.push_back(property);
}

void take_element(const Source& source, std::size_t at, std::string_view line, Header& header) {
    Element element;
    element.name = next_token(line);
    const std::string_view count = next_token(line);
    const auto value = parse_integer<std::uint64_t>(count);
    if (!value) {
        fail_at_line(source, at,
                     "element " + in_quotes(element.name) + " has count " + in_quotes(count) +
                         "; expected a whole number of 0 or more");
    }
    element.count = *value;
    header.elements.push_back(element);
}

void take_format(const Source& source, std::size_t at, std::string_view line, Header& header) {
    header.encoding = next_token(line);
    const std::string_view version = next_token(line);
    const bool known = header.encoding == "ascii" || header.encoding == "binary_little_endian" ||
                       header.encoding == "binary_big_endian";
    if (!known || version != "1.0") {
        fail_at_line(source, at,
                     "format " + in_quotes(header.encoding) + " " + in_quotes(version) +
                         "; expected ascii, binary_little_endian or binary_big_endian, 1.0");
    }
}

void check_header(const Source& source, Header& header) {
    if (header.encoding.empty()) {
        fail(source, "the PLY header has no 'format' line; export the file again");
    }
    const auto is_vertex = [](const Element& e) { return e.name == "vertex"; };
    const auto vertices = std::count_if(header.elements.begin(), header.elements.end(), is_vertex);
    if (vertices != 1) {
        fail(source, "the PLY header has " + std::to_string(vertices) + " elements 'vertex'; expected one");
    }
    const auto vertex = std::find_if(header.elements.begin(), header.elements.end(), is_vertex);
    header.vertex = static_cast<std::size_t>(vertex - header.elements.begin());
    for (std::size_t i = 0; i < 3; ++i) {
        const auto is_axis = [&](const Property& p) { return p.name == kWanted[i] && !p.length; };
        if (std::none_of(vertex->properties.begin(), vertex->properties.end(), is_axis)) {
            fail(source, "element 'vertex' has no property '" + std::string(kWanted[i]) + "'; a scan needs x, y and z");
        }
    }
}

}  // namespace

Header read_header(const Source& source) {
    Header header;
    const std::string_view head = source.bytes.substr(0, kHeaderLimit);
    std::size_t next = 0;
    if (next_line(head, next) != "ply") {
        fail_at_byte(source, 0, "the file does not begin with the line 'ply'; is it another format under this name?");
    }
    while (next < head.size()) {
        const std::size_t at = next;
        std::string_view line = next_line(head, next);
        const std::string_view keyword = next_token(line);
        if (keyword == "end_header") {
            header.data = next;
            check_header(source, header);
            return header;
        }
        if (keyword == "format") {
            take_format(source, at, line, header);
        } else if (keyword == "element") {
            take_element(source, at, line, header);
        } else if (keyword == "property") {
            take_property(source, at, line, header);
        } else if (keyword != "comment" && keyword != "obj_info" && !keyword.empty()) {
            fail_at_line(source, at, in_quotes(keyword) + " is no word of a PLY header");
        }
    }
    fail_at_byte(source, head.size(),
                 "the PLY header does not end; expected 'end_header' within its first 64 KiB" +
                     std::string("; export or copy the file again"));
}

}  // namespace seampath::ply
