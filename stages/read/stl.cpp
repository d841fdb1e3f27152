#include <array>
#include <limits>
#include <string>

#include "stages/read/columns.hpp"
#include "stages/read/formats.hpp"
#include "stages/read/rows.hpp"

namespace seampath {
namespace {

constexpr std::size_t kHeaderBytes = 84;
constexpr std::size_t kFacetBytes = 50;
constexpr std::size_t kNormalBytes = 12;

std::string in_small_letters(std::string_view word) {
    std::string small(word);
    for (char& c : small) {
        c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    }
    return small;
}

std::uint64_t binary_size(std::string_view bytes) {
    return kHeaderBytes + kFacetBytes * static_cast<std::uint64_t>(load(bytes.data() + 80, Scalar::u32, false));
}

bool is_binary(std::string_view bytes) {
    return bytes.size() >= kHeaderBytes && binary_size(bytes) == bytes.size();
}

bool is_ascii(std::string_view bytes) {
    const std::size_t begin = bytes.find_first_not_of(" \t\r\n");
    return begin != std::string_view::npos && in_small_letters(bytes.substr(begin, 5)) == "solid";
}

void add_face(const Source& source, Mesh& mesh) {
    if (mesh.vertices.size() > std::numeric_limits<std::uint32_t>::max()) {
        fail(source, "has more than 1.4 billion faces; expected fewer; split or thin the mesh");
    }
    const auto end = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.faces.push_back({end - 3, end - 2, end - 1});
}

void read_binary(const Source& source, Mesh& mesh) {
    mesh.format = "stl binary";
    const std::size_t count = (source.bytes.size() - kHeaderBytes) / kFacetBytes;
    mesh.vertices.reserve(3 * count);
    mesh.faces.reserve(count);
    for (std::size_t facet = 0; facet < count; ++facet) {
        const char* at = source.bytes.data() + kHeaderBytes + facet * kFacetBytes + kNormalBytes;
        for (int corner = 0; corner < 3; ++corner, at += 12) {
            mesh.vertices.emplace_back(load(at, Scalar::f32, false), load(at + 4, Scalar::f32, false),
                                       load(at + 8, Scalar::f32, false));
        }
        add_face(source, mesh);
    }
}

void read_ascii(const Source& source, Mesh& mesh) {
    // The line that must come at each place: 0 outside of solids, 1 within one (or its end), then those of a facet.
    constexpr std::array<std::string_view, 8> kExpected{"solid",  "facet",  "outer",   "vertex",
                                                        "vertex", "vertex", "endloop", "endfacet"};
    mesh.format = "stl ascii";
    std::size_t place = 0;
    std::size_t next = 0;
    for (std::string_view line = next_row(source.bytes, next); !line.empty(); line = next_row(source.bytes, next)) {
        const auto at = static_cast<std::size_t>(line.data() - source.bytes.data());
        const std::string keyword = in_small_letters(next_token(line));
        if (place == 1 && keyword == "endsolid") {
            place = 0;
            continue;
        }
        if (keyword != kExpected[place]) {
            fail_at_line(source, at,
                         in_quotes(keyword) + " where '" + std::string(kExpected[place]) +
                             "' was expected; export the file again");
        }
        if (keyword == "vertex") {
            mesh.vertices.push_back(take_vector(source, at, line, "expected 'vertex x y z'; export the file again"));
        }
        if (keyword == "endloop") {
            add_face(source, mesh);
        }
        place = keyword == "endfacet" ? 1 : place + 1;
    }
    if (place != 0) {
        fail_at_line(
            source, source.bytes.size(),
            "the file ends where '" + std::string(kExpected[place]) + "' was expected; export or copy the file again");
    }
}

}  // namespace

bool is_stl(std::string_view bytes) {
    return is_binary(bytes) || is_ascii(bytes);
}

Mesh read_stl(const Source& source) {
    Mesh mesh;
    const std::size_t size = source.bytes.size();
    if (is_binary(source.bytes)) {
        read_binary(source, mesh);
    } else if (is_ascii(source.bytes)) {
        read_ascii(source, mesh);
    } else if (size < kHeaderBytes) {
        fail_at_byte(source, size,
                     "the file ends within the 84 bytes that an STL begins with; export or copy the file again");
    } else {
        fail_at_byte(source, 80,
                     "the header promises a file of " + std::to_string(binary_size(source.bytes)) +
                         " bytes, but it has " + std::to_string(size) + "; export or copy the file again");
    }
    return mesh;
}

}  // namespace seampath
