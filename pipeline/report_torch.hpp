#pragma once

#include <string>

#include "pipeline/report_rows.hpp"
#include "pipeline/result.hpp"

namespace seampath {

/// How fast and how leaned the torch is at most, and which seams leave it no room; nothing where no weld is planned.
ReportRows torch_rows(const Plan& plan);

/// Accelerations and angles of the torch over the stations of one seam, every weld of it; "" where none is planned.
std::string torch_plots(const PartResult& part, std::size_t seam);

}  // namespace seampath
