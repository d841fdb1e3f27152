#pragma once

#include "stages/extract/surfels.hpp"

namespace seampath::detail {

/// Turns the surfels' normals so that those of one piece of the scan agree on its side, and says which piece each
/// surfel is of. Sheets are grown along the least bent places first (minimum spanning tree, Hoppe et al. 1992); which
/// way they lie to each other is told by all places at which they touch, and not by the one that is least bent.
void make_consistent(Surfels& surfels);

}  // namespace seampath::detail
