#pragma once

#include <optional>

#include "stages/geometry/pspline.hpp"

/// Seams that turn sharply: curves of smooth pieces that meet in corners.
namespace seampath {

/// A sharp corner between two neighbouring points.
struct SeamCorner {
    std::size_t before = 0;  ///< the point before it; the next one, in a closed seam also the first, is behind it
    Eigen::Vector3d p;       ///< where the pieces on both sides, carried on, meet, mm
};

/// The corners that the points show: the pieces on both sides run smoothly to the last point before it and from the
/// first behind it, as far as the points scatter, and carried on they meet within a few point distances, at 20 deg or
/// more. Each piece is a line, or a parabola where it bends for sure, through as many of the nearest points as it
/// explains. A bend that has points of its own is no corner. Ascending.
std::vector<SeamCorner> corners_of(const CurvePoints& points, bool closed);

/// smooth_points (smoothed.hpp) of each piece between corners, from corner to corner; the curve has a triple knot in
/// each and continuous curvature elsewhere. A closed curve with corners begins in one. Pieces of fewer than 6 points
/// make no corners.
FittedCurve smooth_pieces(CurvePoints& points, bool closed);

}  // namespace seampath
