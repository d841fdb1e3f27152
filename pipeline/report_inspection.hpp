#pragma once

#include <cstddef>
#include <string>

#include "pipeline/report_rows.hpp"

/// What an inspection sheet begins with, as parts of the report's page.
namespace seampath {

/// Part, scan, its date, unit, settings and program.
std::string identity_section(const PartResult& part, const Report& report);

/// Of one seam: its characteristics with nominal, actual, deviation, tolerance, out of tolerance and verdict, and
/// where it is farthest from the scan. Empty for a nominal part.
std::string inspection_tables(const Report& report, std::size_t seam);

/// An empty plot with a control for the station, which the page's script fills with the section there.
std::string section_panel(std::size_t seam);

}  // namespace seampath
