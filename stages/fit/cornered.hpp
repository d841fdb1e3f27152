#pragma once

#include <vector>

#include "stages/geometry/seam_pieces.hpp"
#include "stages/types.hpp"

/// Private to the fit stage: seams with corners.
namespace seampath {

/// Of the seam's nodes, which its corners are among, those of each piece, by the numbers of the piece's points.
std::vector<Nodes> nodes_of_pieces(const Seam& seam, const Nodes& nodes, const std::vector<SeamPiece>& pieces);

/// The models of the pieces as one, but for its reason. Corners are where the tangents of two neighbouring pieces,
/// which end a little off each other, come nearest to each other.
SeamModel join_pieces(const Seam& seam, std::vector<SeamModel> pieces);

}  // namespace seampath
