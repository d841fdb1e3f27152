#pragma once

#include <optional>
#include <span>
#include <vector>

#include "stages/extract/creases.hpp"
#include "stages/geometry/section.hpp"
#include "stages/geometry/slab.hpp"

namespace seampath::detail {

/// One measured place of a seam that is being followed.
struct TrackPoint {
    Section section;
    Eigen::Vector3d t{0, 0, 0};  ///< unit, direction of travel, n1 x n2
    double sigma = 0;            ///< mm
    double bend = 0;             ///< rad
    double along = 0;            ///< mm, half length over which the flanks were fitted
    double away = 0;             ///< mm, how far from the seam the narrower flank is one smooth surface; not of a wall
    double rough = 0;            ///< residual scale of the rougher flank, in its noises
    double flank_scale[2] = {0, 0};  ///< mm, robust 1-sigma of each flank's points about its surface
    double flank_sigma[2] = {0, 0};  ///< mm, of the place across each flank
    std::vector<SlabPoint> slab[2];  ///< points of each flank within half a step of this place
    double support[2] = {0, 0};      ///< points per mm^2 of each flank at this very place
    bool modelled = false;           ///< no support here, but before and after
};

struct Track {
    bool closed = false;
    std::vector<TrackPoint> points;
};

/// What following needs to know of the scan.
struct Tracker {
    const PointGrid& grid;
    const ScaleField& field;
    std::span<const std::size_t> view_starts;      ///< in the order of the scan's points
    SectionWindow (*window_of)(const ScanScale&);  ///< to follow with, or to measure with
    double step = 0;                               ///< mm between track points
    double reach_further = 0;                      ///< mm by which windows are longer along the seam
    std::optional<double> wall = {};               ///< mm, height of the second flank where it is a plate's edge

    ScanScale scale_at(const Section& place) const { return field.at(place.p); }
    SectionWindow window_at(const Section& place) const {
        SectionWindow window = window_of(scale_at(place));
        window.along += reach_further;
        return window;
    }

    SectionWindows windows_at(const Section& place) const {
        const SectionWindow window = window_at(place);
        return wall ? beside_wall(scale_at(place), window, *wall) : SectionWindows(window, window);
    }

    std::optional<TrackPoint> measure(const Section& guess, int rounds) const;
};

/// The section `step` mm beyond the last point of the way, by carrying on its direction and the way it turned over the
/// last points. `direction` is +1 when the way runs along n1 x n2, else -1.
Section carry_on(const std::vector<TrackPoint>& way, double direction, double step);

/// Follows the joint from the seed both ways, by prediction and measurement, until a flank ends, the joint turns flat,
/// or it comes back to its start. `taken` are tracks found before: where one of them is met, this one ends. Empty when
/// the seed does not measure as a joint.
std::optional<Track> follow(const Tracker& tracker, const Crease& seed, const std::vector<Track>& taken);

/// Whether a place with these normals lies on the track already, within `reach` mm.
bool lies_on(const Track& track, const Section& place, double reach);

}  // namespace seampath::detail
