#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "stages/read/columns.hpp"
#include "stages/read/source.hpp"

/// The header of a PLY file. Names are views of the file's bytes.
namespace seampath::ply {

/// Properties that a scan takes, in the order of their slots.
inline constexpr std::array<std::string_view, 6> kWanted{"x", "y", "z", "nx", "ny", "nz"};

struct Property {
    std::string_view name;
    Scalar type = Scalar::f32;
    std::optional<Scalar> length;  ///< type of a list's length
};

struct Element {
    std::string_view name;
    std::uint64_t count = 0;
    std::vector<Property> properties;
};

/// What the file promises.
struct Header {
    std::string_view encoding;
    std::vector<Element> elements;
    std::size_t vertex = 0;  ///< which element
    std::size_t data = 0;    ///< first byte behind the header
};

/// Throws InputError for anything but a whole header with one element vertex that has x, y and z.
Header read_header(const Source& source);

}  // namespace seampath::ply
