#pragma once

#include <optional>
#include <vector>

#include "stages/extract/track.hpp"

/// Where open seams end: where the first of the two flanks does.
namespace seampath::detail {

/// Where a stretch of points ends that holds `density` points per mm up to distance 0; `ahead`: distances beyond it,
/// mm, which are sorted. The end is the likeliest change from that density to that of stray points: each point speaks
/// for going on, each mm without points against it. A hole is passed when the surface goes on behind it, and where four
/// views become one the surface goes on.
double end_of(std::vector<double>& ahead, double density);

/// Whether the way runs straight, as far as noise lets it be seen, from its front or back over `length` mm.
bool straight_end(const std::vector<TrackPoint>& way, bool front, double length, double noise);

/// Hundreds of points that leave the seam less sure than two scan points do not see two surfaces: fits shrink to that
/// in the smooth valleys of bent or badly fused parts.
bool unsure(const Tracker& tracker, const TrackPoint& point);

/// Measures a place `to_end` mm before a straight end. Towards the end the window finds flanks on one side only: it
/// keeps its length by reaching further the other way. Else the place at the end, where the fit is carried on, would be
/// the worst measured of all. What runs straight as far as noise lets it be seen may still bend by more than one
/// surface explains over that length: the window as it is everywhere counts where it is clearly the surer one. Beside a
/// bent end flanks bend too, in ways that the fit does not know so far away.
std::optional<TrackPoint> measure_near_end(const Tracker& tracker, const Section& guess, double to_end);

/// Shortens or lengthens one end so that it lies where the first flank ends. Judged from a few steps inside, where both
/// flanks are whole: fits at the end itself have data on one side only.
void place_end(const Tracker& tracker, std::vector<TrackPoint>& way, bool front);

}  // namespace seampath::detail
