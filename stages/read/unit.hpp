#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "stages/read/read.hpp"
#include "stages/read/source.hpp"

namespace seampath {

struct UnitChoice {
    double mm_per_unit = 1;
    std::string reason;  ///< one sentence for the report
};

/// Largest side of the axis-parallel box that holds all but the outermost 0.1 % of the points at each end of each axis,
/// so that a few stray returns do not speak for the part. Taken from at most 131072 points, evenly spread over the
/// list; below 1000 points it is the whole range. 0 for no points.
double largest_extent(const std::vector<Eigen::Vector3f>& points);

/// The unit of the file: the one that the option names, or by the size of the scan: an extent of 20 or more is in mm,
/// below 2 in metres, in between metres for a PCD. A named unit that the size speaks against is taken, and the reason
/// says so. Throws InputError where nothing settles it.
UnitChoice choose_unit(const Source& source, Unit option, ScanFormat format, double extent);

}  // namespace seampath
