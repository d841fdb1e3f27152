#pragma once

#include "stages/photo/path.hpp"

namespace seampath::detail {

/// The line that is taken for the seam.
struct ChosenLine {
    LinePath path;
    double worth = 0;        ///< of the path and of the borders that it lies between, per block
    double rival_worth = 0;  ///< of the best line elsewhere
    bool between_borders = false;
    double widest = 0;  ///< that the line can be, rows of the reduced picture
};

/// A joint that was prepared shows many lines side by side: the plates' top edges, borders of what was ground. Its seam
/// lies midway between two of them, since both plates are prepared alike. So a line counts with the borders on either
/// side of it, as far as it keeps to their middle; a line without borders counts by itself.
ChosenLine choose_line(const LineEvidence& evidence);

}  // namespace seampath::detail
