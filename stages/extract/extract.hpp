#pragma once

#include <array>
#include <string>
#include <vector>

#include "stages/options.hpp"
#include "stages/types.hpp"

namespace seampath {

enum class JointChoice { automatic, fillet, lap, butt, v_groove, corner, saddle };
inline constexpr std::array<std::string_view, 7> kJointChoiceNames{"auto",     "fillet", "lap",   "butt",
                                                                   "v-groove", "corner", "saddle"};

struct ExtractOptions {
    JointChoice joint = JointChoice::automatic;
    bool convex = false;
    double max_thickness_mm = 0;  ///< of plates whose rims are no corners; 0: by the faces' widths
    double max_step_mm = 1.2;     ///< sheets that are lapped are thicker; machined steps mostly are not
    bool join_at_corners = true;
    double min_length_mm = 0;  ///< 0: from the scan
    double station_mm = 0;     ///< 0: from the scan
};
Fields describe(ExtractOptions&);

/// The seams found, and the numbers that extraction took from the scan.
struct Extraction {
    std::vector<Seam> seams;     ///< longest first
    double spacing_mm = 0;       ///< typical distance of neighbouring points on one surface
    double noise_mm = 0;         ///< rms of points about locally fitted surfaces
    int views = 1;               ///< that the scan was put together from, by the order of its points
    double registration_mm = 0;  ///< 1-sigma of their shifts against each other along any direction; part of sigma_mm
    std::string orientation_reason;    ///< how the side of the air was told from the side of the material
    std::vector<std::string> remarks;  ///< one sentence each, e.g. a candidate that was dropped and why
};

/// Finds every joint of the asked kind: of all kinds but corners when that is left to the scan. An empty `seams` is a
/// result, not an error. Throws InputError when the scan cannot carry a measurement at all (too few points, all in one
/// place).
Extraction extract(const Scan& scan, const ExtractOptions& options);

}  // namespace seampath
