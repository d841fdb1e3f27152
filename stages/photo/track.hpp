#pragma once

#include <vector>

#include "stages/geometry/grey_image.hpp"
#include "stages/photo/choice.hpp"

namespace seampath::detail {

/// The line at one column of the picture.
struct TrackPlace {
    double y = 0;      ///< px, to about one
    double slope = 0;  ///< rows a column
    double width = 0;  ///< px
    LineKind kind = LineKind::dark;
    bool seen = false;  ///< the line stands out there
};

/// A path follows a ragged line only so far; here it is followed from column to column, within what the path may be
/// off. One place each `kTrackStep` columns from the left border to the right one.
std::vector<TrackPlace> track_line(const GreyImage& image, const LineEvidence& evidence, const LinePath& path,
                                   double px_per_row);

inline constexpr int kTrackStep = 2;

}  // namespace seampath::detail
