#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "stages/geometry/grid.hpp"
#include "stages/geometry/scale.hpp"
#include "stages/geometry/section.hpp"

namespace seampath::detail {

/// The raw scan near the model.
struct Ground {
    const Eigen::Vector3d& origin;  ///< of the grid, mm
    const PointGrid& grid;
    const std::vector<std::size_t>& views;  ///< as from view_starts()
    const ScanScale& scale;
    const SectionWindow& window;
};

}  // namespace seampath::detail
