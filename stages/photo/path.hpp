#pragma once

#include <span>
#include <vector>

#include "stages/photo/evidence.hpp"

namespace seampath::detail {

/// A path's place in one block.
struct PathPlace {
    int row = 0;    ///< of the reduced picture
    int slope = 0;  ///< in steps of 1 / kSlopes
    LineKind kind = LineKind::dark;
    LineSign sign;
};

/// One place a block, from left to right.
struct LinePath {
    std::vector<PathPlace> places;
    double worth = 0;  ///< per block
};

/// Where a path may run, one entry a block: at most `share` of `half` from the middle, and the nearer the better.
struct Corridor {
    std::vector<double> middle, half;  ///< rows of the reduced picture
    static constexpr double kShare = 0.25;
    static constexpr double kCharge = 25;  ///< of the worth a block, times the squared share
};

/// The path from the left border to the right one that is worth most: the sum of what stands out along it, each block's
/// share limited so that nothing bright or black outweighs the rest, less a charge for every bend and every change of
/// kind. It is found by dynamic programming over rows and slopes, so it goes straight on where nothing shows the line.
/// `kinds`: what it may consist of. Places near `taken` paths are of no worth.
LinePath best_path(const LineEvidence& evidence, std::span<const LineKind> kinds, std::span<const LinePath> taken,
                   const Corridor* corridor = nullptr);

}  // namespace seampath::detail
