#pragma once

#include <cstdint>
#include <string>

#include "datasets/fixture_scenes.hpp"
#include "datasets/surface_scenes.hpp"

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

/// A scan of 300 000 points or `width` x 0.73 `width`, of which 30 % lie on the part, laid on the part's mesh; the seed
/// picks one of the parts that have one pose, which turns and stands anywhere. Good within 0.02 mm at the part's middle
/// and 0.005 degrees.
CaseResult surface_case(std::uint64_t first_seed, int sets, int width = 640);

/// The same of parts with an open direction or several poses that look alike. Good when refused, and the reason named.
CaseResult open_surface_case(std::uint64_t first_seed, int sets, int width = 640);

}  // namespace seampath
