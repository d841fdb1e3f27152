#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "stages/geometry/grid.hpp"

namespace seampath {

/// A place of a groove, and how the line that the groove is measured from runs through it: in direction t, bending by
/// `bend`. Sections across it have the coordinates a, to the left of travel, and h, up.
struct GrooveFrame {
    Eigen::Vector3d p{0, 0, 0};     ///< mm, in the frame of the grid
    Eigen::Vector3d t{1, 0, 0};     ///< unit, along travel
    Eigen::Vector3d up{0, 0, 1};    ///< unit, square to t, out of the material
    Eigen::Vector3d bend{0, 0, 0};  ///< curvature vector, square to t, 1/mm

    Eigen::Vector3d left() const { return up.cross(t); }
    Eigen::Vector3d direction(const Eigen::Vector2d& x) const { return x[0] * left() + x[1] * up; }
    Eigen::Vector3d at(const Eigen::Vector2d& x) const { return p + direction(x); }
};

/// A point of the scan beside a place: s along the bent line, a and h off it. A groove of constant section along an arc
/// is straight in these.
struct GroovePoint {
    float s, a, h;
    std::uint32_t view;
    Eigen::Vector2d section() const { return {a, h}; }
    /// Carried back to the place itself, along a surface that drifts by this much per mm of s.
    Eigen::Vector2d section(const Eigen::Vector2d& drift) const { return section() - s * drift; }
};

/// Part of a section: from `low` to `high` in a and h, mm.
struct GrooveBox {
    Eigen::Vector2d low, high;
};

GroovePoint unrolled(const GrooveFrame& frame, const Eigen::Vector3d& q, std::uint32_t view);

/// The points of the grid within s from `back` to `ahead` and within the box. `view_starts`: index, in the order of the
/// points that the grid was made of, at which each view begins.
std::vector<GroovePoint> groove_points(const PointGrid& grid, std::span<const std::size_t> view_starts,
                                       const GrooveFrame& frame, double back, double ahead, const GrooveBox& box);

}  // namespace seampath
