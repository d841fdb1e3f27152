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

/// The same from memory. `name` goes into the scan and into messages.
Scan read_bytes(std::span<const std::byte> bytes, ScanFormat format, const std::string& name,
                const ReadOptions& options);

}  // namespace seampath
