#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "stages/fit/fit.hpp"
#include "stages/geometry/interpolate.hpp"
#include "stages/geometry/pspline.hpp"

/// Private to the fit stage: what the interpolating models interpolate.
namespace seampath {

/// Nodes that a closed seam is carried on by beyond both ends: what a polynomial of degree 5, and with it every local
/// method, sees of its neighbours.
inline constexpr std::ptrdiff_t kBeyond = 6;

/// Positions over a parameter.
struct NodeTable {
    std::vector<double> t;
    std::vector<Eigen::Vector3d> p;
    std::vector<double> s;  ///< arc length at the same places along the polygon of the seam's points, mm
    double period = 0;      ///< of t, for a closed seam
};

/// Arc length along the polygon of the points, one a point; for a closed seam one more, where it is back.
std::vector<double> lengths(const std::vector<Eigen::Vector3d>& p, bool closed);

/// The nodes as `place` chose them, in the frame of the points, over arc length along the line they were placed on: the
/// points' polygon where the nodes are points. `s` is lengths(points.p). Throws InputError where t would not ascend.
NodeTable placed_nodes(const CurvePoints& points, const std::vector<double>& s, const Nodes& nodes, bool closed,
                       const FitOptions& options);

/// As many nodes at equal steps of the parameter, read off Akima's line through all points.
NodeTable equal_nodes(const CurvePoints& points, const std::vector<double>& s, const NodeTable& like, bool closed,
                      const FitOptions& options);

/// A closed seam's table with `before` and `behind` nodes more, as it goes on over its ends; without `s`.
NodeTable carried_on(const NodeTable& ring, std::ptrdiff_t before, std::ptrdiff_t behind);

/// x(t), y(t) and z(t).
using Lines = std::array<Interpolant, 3>;
Lines interpolated(const NodeTable& table, Method method, const InterpolateOptions& options);

}  // namespace seampath
