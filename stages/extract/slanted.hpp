#pragma once

#include <vector>

#include "stages/extract/around.hpp"
#include "stages/types.hpp"

namespace seampath::detail {

/// Straight fillets of plane faces that the scanner saw at such a slant that too few points lie on them for windows:
/// two to five times as far apart as on the rest of the scan. Such a face is one plane or nothing; where it meets a
/// well-seen plane with the air between them, the seam is the line of both, as far as both have points beside it. What
/// is still sparser may as well be pixels mixed of an edge and what lies behind it, and is no face. `known` are seams
/// that need not be found again.
std::vector<Seam> find_slanted_fillets(const Around& around, const std::vector<Seam>& known, double min_length_mm);

}  // namespace seampath::detail
