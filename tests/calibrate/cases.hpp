#pragma once

#include <cstdint>
#include <string>

#include "datasets/fixture_scenes.hpp"

/// Calibrations of made scenes against their truth; a test looks at a few seeds, a program at all.
namespace seampath {

/// One case over seeds.
struct CaseResult {
    int sets = 0;
    double rms_mm = 0;  ///< at the case's far point
    double largest_mm = 0;
    double largest_rad = 0;
    int inside = 0;    ///< sets whose truth lies in the 95 % region of the covariance
    int good = 0;      ///< sets within the case's limits, or named as asked
    std::string note;  ///< what went wrong first
};

/// Four balls of 12.7 mm over 400 mm among clutter: error at a point 1.5 bases away.
CaseResult ball_case(std::uint64_t first_seed, int sets);

/// One of them moved by 0.2 mm: good when it alone is named.
CaseResult moved_ball_case(std::uint64_t first_seed, int sets);

}  // namespace seampath
