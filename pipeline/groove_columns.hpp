#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "stages/angle.hpp"
#include "stages/types.hpp"

/// The numbers of a groove's section as tables, plots and reports show them.
namespace seampath {

struct GrooveColumn {
    std::string_view name;  ///< without its unit
    std::string_view unit;  ///< as it ends a column's name
    std::string_view shown_unit;
    std::string_view label;
    Measured GrooveStation::*number;
    double per_unit;  ///< of the unit that is shown, per that of the number
};

inline constexpr std::array<GrooveColumn, 8> kGrooveColumns{{
    {"gap", "mm", "mm", "Root gap", &GrooveStation::gap_mm, 1},
    {"mismatch", "mm", "mm", "Height mismatch", &GrooveStation::mismatch_mm, 1},
    {"included_angle", "deg", "°", "Included angle", &GrooveStation::included_angle_rad, kDegreesPerRadian},
    {"bevel_1", "deg", "°", "Bevel angle of plate 1", &GrooveStation::bevel1_rad, kDegreesPerRadian},
    {"bevel_2", "deg", "°", "Bevel angle of plate 2", &GrooveStation::bevel2_rad, kDegreesPerRadian},
    {"depth", "mm", "mm", "Depth", &GrooveStation::depth_mm, 1},
    {"root_face", "mm", "mm", "Root face", &GrooveStation::root_face_mm, 1},
    {"area", "mm2", "mm²", "Cross-section area", &GrooveStation::area_mm2, 1},
}};

/// A column's number and sigma at every point of a seam, in the unit that is shown; NaN where the scan does not show
/// it.
std::vector<Measured> groove_values(const Seam& seam, const GrooveColumn& column);

}  // namespace seampath
