#pragma once

#include <vector>

#include "stages/types.hpp"

/// A seam that turns sharply, as the smooth open ones between its corners. Each of them begins and ends at a corner, or
/// at an end of the seam; of a closed one the first begins where the seam does.
namespace seampath {

struct SeamPiece {
    std::vector<std::size_t> index;  ///< of each of its points among the seam's
    Seam seam;                       ///< its ends have the normals of their neighbours
};
std::vector<SeamPiece> pieces_of(const Seam& seam);

struct ModelPiece {
    double from_mm = 0;  ///< station at which it begins
    SeamModel model;
};
std::vector<ModelPiece> pieces_of(const SeamModel& model);

}  // namespace seampath
