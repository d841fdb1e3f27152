#pragma once

#include "stages/options.hpp"
#include "stages/types.hpp"

namespace seampath {

/// What nodes are placed for: straight moves from one to the next, a cubic spline through them, or such a spline
/// through nodes at equal steps along the seam, to compare with.
enum class PlaceMethod { chord, spline, uniform };
inline constexpr std::array<std::string_view, 3> kPlaceMethodNames{"chord", "spline", "uniform"};
inline std::string_view name(PlaceMethod method) {
    return kPlaceMethodNames[static_cast<std::size_t>(method)];
}

struct PlaceOptions {
    double chord_tolerance_mm = 0.05;
    double max_spacing_mm = 25;
    PlaceMethod method = PlaceMethod::chord;
    double spline_tolerance_mm = 0.01;
    double min_spacing_mm = 0;
};
Fields describe(PlaceOptions&);

/// Few seam points that carry the shape of the seam.
///
/// `chord`: the fewest seam points such that every seam point lies within the chord tolerance of its interval's chord:
/// every sample under the chord is tested, not only the middle. Where chords follow a smooth curve they become as dense
/// as the root of its curvature. No chord is longer than `max_spacing_mm`, as far as the points lie so close.
///
/// `spline`: few places on a smooth line through the seam's points (smoothed.hpp), each the foot of a seam point,
/// such that the cubic spline through them over arc length, periodic or with ends that are not a knot, stays within the
/// spline tolerance of that line. They are as dense as the fourth root of its fourth derivative, which is what the
/// spline's error follows (de Boor, A Practical Guide to Splines, ch. XII: NEWNOT), corrected by the error found
/// between every two nodes; their number is lowered until none does, and then each is left out that can be. The line is
/// looked at in all seam points' feet and between them. Where `min_spacing_mm` forbids what the tolerance asks for,
/// Nodes::line says what error is left.
///
/// `uniform`: the fewest places at equal steps along that line, to the nearest seam point, with which the spline holds
/// the same tolerance.
///
/// Corners of the seam are nodes, and nodes between two of them are placed as if there was nothing else.
///
/// Throws InputError for fewer than 4 points, a seam without length, and a least spacing above the largest.
Nodes place(const Seam& seam, const PlaceOptions& options);

}  // namespace seampath
