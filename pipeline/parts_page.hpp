#pragma once

#include <string>
#include <vector>

#include "pipeline/result.hpp"

/// The page over the many parts of one run.
namespace seampath {

/// One part, as its row shows it.
struct PartRow {
    std::string name;
    std::string folder;  ///< of the part, from that of the page
    bool pass = false;
    bool has_report = false;  ///< a part that failed to run has none, and no numbers
    std::string sentence;     ///< the report's verdict, or why there is none
    std::size_t seams = 0;
    double length_mm = 0;
    double deviation_max_mm = 0;
    double tolerance_used = 0;  ///< of its worst seam: deviation with its guard over the tolerance; above 1 fails
    double coverage = 0;        ///< share of the seams' length that was checked, 0..1
    double duration_s = 0;      ///< of the torch path
    std::string picture;        ///< SVG of its seams
};

/// What a run found, but for name and folder.
PartRow part_row(const PartResult& part);

/// One file that needs no network: a row a part, worst first, which a click on a heading sorts otherwise; each with a
/// picture of its seams and a link to its report.
std::string parts_page(std::vector<PartRow> parts);

}  // namespace seampath
