#pragma once

#include <array>
#include <vector>

#include "pipeline/report_view.hpp"

namespace seampath {

/// At most 200 000 points of the scan: those within some millimetres of the seams, thinned least, and the rest. Which
/// points are kept depends on their index alone. Positions are relative to `centre`.
std::array<ViewCloud, 2> thin_scan(const Scan& scan, const std::vector<Seam>& seams, const Eigen::Vector3d& centre);

}  // namespace seampath
