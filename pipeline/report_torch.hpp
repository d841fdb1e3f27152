#pragma once

#include <string>
#include <vector>

#include "pipeline/report_rows.hpp"
#include "pipeline/result.hpp"
#include "pipeline/svg.hpp"

namespace seampath {

/// How fast and how leaned the torch is at most, and which seams leave it no room; nothing where no weld is planned.
ReportRows torch_rows(const Plan& plan);

/// The speed that was planned over the stations of one seam, broken between welds.
std::vector<PlotPoint> planned_speed(const PartResult& part, std::size_t seam);

/// Accelerations and angles of the torch over the stations of one seam, every weld of it; "" where none is planned.
std::string torch_plots(const PartResult& part, std::size_t seam);

}  // namespace seampath
