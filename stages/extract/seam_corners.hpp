#pragma once

#include <vector>

#include "stages/types.hpp"

namespace seampath::detail {

/// Makes one seam of fillets that go on round a corner: two of their ends, and no third, have one flank in common, and
/// the lines in which their flanks meet come together within `reach` mm of both. Seam::corners says where; a corner's
/// 1-sigma counts that nothing was measured on the last bit of the way to it.
void join_at_corners(std::vector<Seam>& seams, double reach);

}  // namespace seampath::detail
