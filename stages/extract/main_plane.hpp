#pragma once

#include <optional>
#include <string>

#include "stages/extract/surfels.hpp"

namespace seampath::detail {

/// Whether a ray from p along d meets the scan between `start` and `end` mm, by steps through the occupied cells.
bool blocked(const PointGrid& grid, const Eigen::Vector3d& p, const Eigen::Vector3d& d, double start, double end);

/// Where one plane is much of the scan and nearly all else lies on one side of it, turns the normals by it, and those
/// of large pieces without a share in it by their own such planes; says in a sentence how. That side is the air: parts
/// stand on plates and tables, and nothing is seen through them. It is the material, though, when what lies there are
/// walls along the plane's outline that are low or opposite to each other: a block's own sides.
std::optional<std::string> turn_to_side_of_main_plane(Surfels& surfels, const PointGrid& grid);

}  // namespace seampath::detail
