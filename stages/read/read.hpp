#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "stages/options.hpp"
#include "stages/types.hpp"

namespace seampath {

enum class Unit { automatic, mm, m, inch };
inline constexpr std::array<std::string_view, 4> kUnitNames{"auto", "mm", "m", "inch"};

struct ReadOptions {
    Unit unit = Unit::automatic;
    double mesh_spacing_mm = 0.2;
};
Fields describe(ReadOptions&);

enum class ScanFormat { ply, pcd, text, stl, obj };

/// Reads one scan file; the format follows from the extension and, where it is unknown, from the first bytes.
/// Throws InputError naming the byte or line, what was expected and what to do; never allocates more than the file can
/// hold.
Scan read(const std::filesystem::path& file, const ReadOptions& options);

/// Reads a surface to hold scans against: a mesh (STL, OBJ, or PLY with faces) as about `count` evenly spread points
/// with the normals of its faces; any other file, e.g. a golden scan, as read() does.
Scan read_surface(const std::filesystem::path& file, Unit unit, std::size_t count);

/// The same as read() from memory. `name` goes into the scan and into messages.
Scan read_bytes(std::span<const std::byte> bytes, ScanFormat format, const std::string& name,
                const ReadOptions& options);

}  // namespace seampath
