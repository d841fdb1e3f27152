#pragma once

#include <vector>

#include "stages/extract/around.hpp"
#include "stages/extract/borders.hpp"
#include "stages/geometry/border_section.hpp"

namespace seampath::detail {

/// A place of a gap between two plates.
struct GapStation {
    GapFit fit;
    bool modelled = false;  ///< bridged, between places that were measured
};

/// A gap from end to end, in the direction of travel.
struct GapWay {
    std::vector<GapStation> at;
    bool closed = false;
};

/// The scan's points with their views.
ViewedPoints viewed_points(const Around& around);

/// Whether what was fitted is a gap that a butt joint can have, between tops that lie alike.
bool is_gap(const GapFit& fit, const ScanScale& scale);

/// How far apart the points of the tops beside a gap are, across it, mm: the widest empty strip that is as long as
/// twelve point distances and nearer to the gap than that.
double row_distance(const Around& around, const GapPlace& place);

/// Between two places, x of the way from a to b.
GapPlace between(const GapPlace& a, const GapPlace& b, double x);

/// Follows the gaps that begin at the borders, each until it is no longer seen, or comes back to its start.
std::vector<GapWay> follow_gaps(const Around& around, const std::vector<Border>& borders);

}  // namespace seampath::detail
