#pragma once

#include <vector>

#include "stages/geometry/grey_image.hpp"
#include "stages/photo/choice.hpp"

namespace seampath::detail {

/// The line at one column of the picture.
struct TrackPlace {
    double y = 0;      ///< px, to a few
    double slope = 0;  ///< rows a column
    double width = 0;  ///< px
    LineKind kind = LineKind::dark;
    bool seen = false;  ///< the line stands out there
};

/// The chosen line once more, in the picture itself: the strip about it is laid out straight and searched in the same
/// way, for lines about as wide as the line is for the most part. One place each `kTrackStep` columns from the left
/// border to the right one.
std::vector<TrackPlace> track_line(const GreyImage& image, const LineEvidence& evidence, const ChosenLine& line,
                                   double px_per_row);

inline constexpr int kTrackStep = 2;

}  // namespace seampath::detail
