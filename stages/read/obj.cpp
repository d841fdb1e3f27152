#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <vector>

#include "stages/read/formats.hpp"
#include "stages/read/rows.hpp"

namespace seampath {
namespace {

/// Words of the format that say nothing about points and faces.
constexpr std::array<std::string_view, 40> kPassedOver{
    "vt",     "vp",    "p",     "l",    "curv",     "curv2",    "surf",   "deg",    "bmat",       "step",
    "cstype", "parm",  "trim",  "hole", "scrv",     "sp",       "end",    "con",    "g",          "s",
    "mg",     "o",     "bevel", "lod",  "c_interp", "d_interp", "usemap", "maplib", "usemtl",     "mtllib",
    "ctech",  "stech", "call",  "csh",  "bzp",      "bsp",      "cdc",    "cdp",    "shadow_obj", "trace_obj"};

struct ObjReader {
    const Source& source;
    Mesh mesh;
    std::size_t highest_index = 0;  ///< of any face, from 1
    std::size_t highest_at = 0;     ///< byte of that face's line

    Eigen::Vector3d three_numbers(std::size_t at, std::string_view line) const {
        return take_vector(source, at, line, "expected three; repair or remove this line");
    }

    /// Index from 0 of one corner: "v", "v/vt", "v//vn" or "v/vt/vn"; negative ones count back from the last vertex.
    std::uint32_t take_corner(std::size_t at, std::string_view token) {
        const auto index = parse_integer<std::int64_t>(token.substr(0, token.find('/')));
        const auto known = static_cast<std::int64_t>(mesh.vertices.size());
        if (!index || token.find_first_not_of("0123456789-/") != std::string_view::npos) {
            fail_at_line(source, at,
                         in_quotes(token) +
                             " is no corner of a face; expected v, v/vt, v//vn or v/vt/vn with whole "
                             "numbers; repair or remove this line");
        }
        if (*index == 0 || *index < -known || *index > std::numeric_limits<std::uint32_t>::max()) {
            fail_at_line(source, at,
                         "vertex index " + std::to_string(*index) + " with " + std::to_string(known) +
                             " vertices before it; expected 1 or more, or -1 or less within them; export the file "
                             "again");
        }
        const auto from_one = static_cast<std::size_t>(*index > 0 ? *index : known + *index + 1);
        if (from_one > highest_index) {
            highest_index = from_one;
            highest_at = at;
        }
        return static_cast<std::uint32_t>(from_one - 1);
    }

    void take_face(std::size_t at, std::string_view line) {
        std::size_t corners = 0;
        std::array<std::uint32_t, 3> face{};
        for (std::string_view token = next_token(line); !token.empty(); token = next_token(line)) {
            const std::uint32_t corner = take_corner(at, token);
            if (corners >= 3) {
                face[1] = face[2];
            }
            face[std::min<std::size_t>(corners, 2)] = corner;
            if (++corners >= 3) {
                mesh.faces.push_back(face);
            }
        }
        if (corners < 3) {
            fail_at_line(
                source, at,
                "a face with " + std::to_string(corners) + " corners; expected at least 3; repair or remove this line");
        }
    }

    void take_line(std::size_t at, std::string_view line) {
        const std::string_view keyword = next_token(line);
        if (keyword == "v") {
            mesh.vertices.push_back(three_numbers(at, line));
        } else if (keyword == "vn") {
            mesh.normals.push_back(three_numbers(at, line));
        } else if (keyword == "f") {
            take_face(at, line);
        } else if (std::find(kPassedOver.begin(), kPassedOver.end(), keyword) == kPassedOver.end()) {
            fail_at_line(source, at,
                         in_quotes(keyword) +
                             " is no word of an OBJ file; expected v, vn, f or the like; is it "
                             "another format under this name?");
        }
    }
};

}  // namespace

Mesh read_obj(const Source& source) {
    ObjReader reader{source, {}};
    reader.mesh.format = "obj";
    std::size_t next = 0;
    for (std::string_view line = next_row(source.bytes, next); !line.empty(); line = next_row(source.bytes, next)) {
        reader.take_line(static_cast<std::size_t>(line.data() - source.bytes.data()), line);
    }
    if (reader.highest_index > reader.mesh.vertices.size()) {
        fail_at_line(source, reader.highest_at,
                     "vertex index " + std::to_string(reader.highest_index) + " in a file of " +
                         std::to_string(reader.mesh.vertices.size()) + " vertices; export or copy the file again");
    }
    return std::move(reader.mesh);
}

}  // namespace seampath
