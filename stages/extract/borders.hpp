#pragma once

#include <vector>

#include <Eigen/Core>

#include "stages/extract/around.hpp"

/// Where smooth sheets of the scan end, and what lies beyond: seeds of the joints of plates.
namespace seampath::detail {

/// A piece of a sheet's border, straight over a neighbourhood.
struct Border {
    Eigen::Vector3d p;    ///< on the border, mm
    Eigen::Vector3d n;    ///< unit, normal of the sheet, out of the material
    Eigen::Vector3d out;  ///< unit, within the sheet, square to the border, away from the sheet
    double density = 0;   ///< of the sheet, points per mm^2
};

/// What lies beyond a border: another sheet that is parallel to the first.
struct Beyond {
    double gap = 0;     ///< mm from the border to where the other sheet begins, along `out`
    double height = 0;  ///< mm, of the other sheet above the first
};

/// Borders all over the scan, by its raw points: a gap of one and a half point distances is none to cells. A strip as
/// long as the neighbourhood and as wide as the points are apart must be emptier beside the sheet than chance would
/// leave it in a hundred scans.
std::vector<Border> find_borders(const Around& around);

/// The nearest parallel sheet beyond the border, at most `reach` mm across and between `lowest` and `highest` mm high
/// over the first.
std::optional<Beyond> sheet_beyond(const Around& around, const Border& border, double reach, double lowest,
                                   double highest);

}  // namespace seampath::detail
