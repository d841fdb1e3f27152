#pragma once

#include <cstddef>
#include <vector>

namespace seampath::detail {

/// Heights at even distances, of which some are measured.
struct Heights {
    std::vector<double> y;
    std::vector<bool> measured;  ///< one a height
};

/// A smooth line through heights.
struct SmoothLine {
    std::vector<double> y;  ///< one a height
    double length = 0;      ///< period of the shortest waves that the line follows by half, in distances
    double scatter = 0;     ///< robust 1-sigma of a measured height about the line
    double sigma = 0;       ///< 1-sigma of the line, from the blocks that it was to predict
};

/// The line f with the least sum of sizes of y - f and of lambda (f'')^2: P. H. C. Eilers, A perfect smoother, Anal.
/// Chem. 75(14), 2003, its weights anew until the sizes count and not the squares, as flaws lie to one side of a seam
/// and are large. Where nothing is measured it goes on as the penalty has it: a cubic between, straight beyond the
/// ends. How smooth it is the heights say: blocks of `block` heights are left out in turns, and of the lines that
/// predict them as well as the best one does, within its standard error (T. Hastie et al., The Elements of Statistical
/// Learning, 7.10), the smoothest is taken. A block is longer than what neighbouring errors share.
SmoothLine smooth_line(const Heights& heights, std::size_t block);

}  // namespace seampath::detail
