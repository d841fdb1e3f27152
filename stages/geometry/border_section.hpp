#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "stages/geometry/flank.hpp"
#include "stages/geometry/grid.hpp"
#include "stages/types.hpp"

/// The section across a gap between two plates, at one place.
namespace seampath {

/// The points of the scan, and which view of it each came from.
struct ViewedPoints {
    const PointGrid& grid;
    std::span<const std::size_t> view_starts;  ///< in the order of the scan's points, ascending from 0
};

/// Where to look. Plate 1 lies on the right of t, seen from the side of n.
struct GapPlace {
    Eigen::Vector3d p;    ///< middle of the two top edges, mm, in the frame of the grid
    Eigen::Vector3d t;    ///< unit, along the gap
    Eigen::Vector3d n;    ///< unit, normal of the tops, out of the material; square to t
    double gap = 0;       ///< mm
    double mismatch = 0;  ///< mm, height of plate 2 above plate 1
    double bend = 0;      ///< 1/mm, curvature of the gap within the tops, above 0 to the left of travel
};

struct GapFit {
    GapPlace place;
    Eigen::Vector3d n1, n2;  ///< normals of the two tops at their edges
    Measured gap, mismatch;  ///< mm; sigmas without what the views' registration does
    double sigma = 0;        ///< mm, of place.p across the gap, the same
    double shift = 0;        ///< variance of place.p across the gap per variance of the views' shifts
    /// How far each view's points lie off both tops, mm, and how many they are.
    struct ViewOff {
        double sum = 0, count = 0;
    };
    std::map<std::uint32_t, ViewOff> views;
    double support[2] = {0, 0};       ///< points per mm^2 of each top right at the section
    bool walled[2] = {false, false};  ///< the edge's wall was seen below the top, and took part
};

/// Widest gap, and largest mismatch, between plates that are taken to be joined square, mm.
inline constexpr double kMostGap = 3;
inline constexpr double kMostMismatch = 2.5;

/// A first guess of the gap at p from the points within `along` mm to each side. Empty when the plates are not there.
std::optional<GapPlace> find_gap(const ViewedPoints& scan, const ScanScale& scale, const GapPlace& without_gap,
                                 double along);

/// The window cut to where a gap of that bend is known by it: the term of a circle after the bend's stays below a fifth
/// of the noise.
SectionWindow within_bend(SectionWindow window, double bend, const ScanScale& scale);

/// Measures the gap around `guess`, over window.along to each side and window.away across each plate. A top is the
/// surface fitted to the points beside the gap (see fit_flank); where it ends, the scan's views tell (see find_edge).
/// Empty when a side has too few points or no view tells of its edge, and when the gap is not empty: the wall of a step
/// is none.
std::optional<GapFit> fit_gap(const ViewedPoints& scan, const ScanScale& scale, const GapPlace& guess,
                              const SectionWindow& window);

/// Repeats fit_gap from its own result, at most `rounds` times, within the section plane of the guess.
std::optional<GapFit> settle_gap(const ViewedPoints& scan, const ScanScale& scale, const GapPlace& guess,
                                 const SectionWindow& window, int rounds);

}  // namespace seampath
