#pragma once

#include <cstdint>
#include <string>

#include "datasets/fixtures/fixture_scenes.hpp"
#include "datasets/fixtures/surface_scenes.hpp"

/// Calibrations of made scenes against their truth; a test looks at a few seeds, a program at all.
namespace seampath {

/// One case over seeds.
struct CaseResult {
    int sets = 0;
    int measured = 0;     ///< of them, those that gave a frame to hold against the truth
    double rms_mm = 0;    ///< of those, at the case's far point
    double sigma_mm = 0;  ///< the same by their covariances
    double largest_mm = 0;
    double largest_rad = 0;
    int inside = 0;    ///< measured sets whose truth lies in the 95 % region of the covariance
    int good = 0;      ///< sets within the case's limits, or named as asked
    std::string note;  ///< what went wrong first
};

/// Four balls of 12.7 mm over 400 mm among clutter: error at a point 1.5 bases away.
CaseResult ball_case(std::uint64_t first_seed, int sets);

/// Touched points with their noise, on the points and datum planes of one part; far point as above. Good when it
/// passes.
enum class Touched { points, three_points, planes };
CaseResult touched_case(Touched kind, std::uint64_t first_seed, int sets);

/// Datum planes in a scan with 0.03 mm of noise, among clutter, near a pose that is off by up to 4 mm and 2 degrees;
/// far point 300 mm from their corner. Good when it passes.
CaseResult probed_case(std::uint64_t first_seed, int sets);

/// Points on three seams, in any pose, with noise across them.
CaseResult seam_case(std::uint64_t first_seed, int sets);

/// Corners of one board before a camera, 0.1 px of noise; far point 300 mm from it.
CaseResult board_case(std::uint64_t first_seed, int sets);

/// One of them moved by 0.2 mm: good when it alone is named.
CaseResult moved_ball_case(std::uint64_t first_seed, int sets);

/// A scan of 300 000 points or `width` x 0.73 `width`, of which 30 % lie on the part, laid on the part's mesh; the seed
/// picks one of the parts that have one pose, which turns and stands anywhere. Good within 0.02 mm at the part's middle
/// and 0.005 degrees.
CaseResult surface_case(std::uint64_t first_seed, int sets, int width = 640);

/// The same of parts with an open direction or several poses that look alike. Good when refused, and the reason named.
CaseResult open_surface_case(std::uint64_t first_seed, int sets, int width = 640);

/// A scan laid on a golden one: the same part, any of all, seen from another place, known to within 20 mm and 30
/// degrees. Good within 0.1 mm at the part's middle and 0.05 degrees, or refused; those not refused are measured.
CaseResult golden_case(std::uint64_t first_seed, int sets, int width = 640);

/// The same of parts that have one pose, seen from the golden scan's side within 50 degrees, as a part that comes back
/// to its fixture is. Good within those limits.
CaseResult same_side_case(std::uint64_t first_seed, int sets, int width = 640);

}  // namespace seampath
