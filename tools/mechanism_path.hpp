#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include <Eigen/Core>

/// What `seampath mechanism` is to follow.
namespace seampath {

struct MechanismPath {
    std::vector<Eigen::Vector2d> points;             ///< polyline in the mechanism's plane, mm
    std::optional<std::array<double, 2>> height_mm;  ///< least and largest z of what was projected, where it has one
};

/// A table of points, or one seam of a run, projected along z to the mechanism's plane.
///
/// Of a table the columns x and y (or x_mm, y_mm) by name, else the first two. A column `seam` says which rows belong
/// together. Of a run's folder the fitted curve of the seam, closed if it is, within plan.chord_tolerance_mm of the
/// run, where export.base_from_scan puts it: the mechanism's centre is the origin of the base. `seam` may be left out
/// where there is only one. Throws InputError for files and folders that can't be read or hold no such seam, and for
/// several seams without `seam`.
MechanismPath mechanism_path(const std::filesystem::path& file, std::optional<int> seam);

}  // namespace seampath
