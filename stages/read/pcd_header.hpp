#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "stages/read/columns.hpp"
#include "stages/read/source.hpp"

/// The header of a PCD file. Names are views of the file's bytes.
namespace seampath::pcd {

/// Fields that a scan takes, in the order of their slots.
inline constexpr std::array<std::string_view, 6> kWanted{"x", "y", "z", "normal_x", "normal_y", "normal_z"};
inline constexpr std::array<double, 7> kDefaultViewpoint{0, 0, 0, 1, 0, 0, 0};

struct Field {
    std::string_view name;
    std::uint64_t size = 4;
    char type = 'F';
    std::uint64_t count = 1;
    Scalar scalar = Scalar::f32;
    std::size_t offset = 0;  ///< within a record
};

/// What the file promises.
struct Header {
    std::vector<Field> fields;
    std::uint64_t width = 0;
    std::uint64_t height = 0;
    std::uint64_t points = 0;  ///< width * height
    std::array<double, 7> viewpoint = kDefaultViewpoint;
    std::string_view encoding;
    std::size_t record_size = 0;
    std::size_t data = 0;  ///< first byte behind the header
};

/// Throws InputError for anything but a whole header with fields x, y and z and counts that agree.
Header read_header(const Source& source);

/// The field of that name that holds one number a point, or null.
const Field* find_field(const Header& header, std::string_view name);

/// Whether the three fields of a normal are all there.
bool has_normals(const Header& header);

}  // namespace seampath::pcd
