#pragma once

#include <string>

#include "pipeline/report_image.hpp"
#include "pipeline/result.hpp"

namespace seampath {

/// report.json: rows of {name, value, unit, verdict} for the part, the scan, each seam and each program file, and what
/// each stage made of what; no times, so that the same run gives the same bytes. A verdict is "pass", "fail" or null
/// where there is nothing to judge; a value that is not finite is null. Seams count from 0, as in the other files of
/// the run folder.
std::string report_json(const PartResult& part);

/// report.html: one page that needs no network: the verdict, the same numbers as report.json (which it carries whole in
/// <script id="report">), a 3D view of scan, seams, nodes and torch, and plots. Cells that show a number carry the path
/// of its row in report.json as data-row and the unrounded value as data-value. Without WebGL or scripts it shows a
/// still picture instead of the 3D view. `#hide=scan,nodes` in the address opens the page with those layers off.
/// `images`: pictures that the part was measured in.
std::string report_html(const PartResult& part, const std::vector<ReportImage>& images = {});

}  // namespace seampath
