#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "stages/geometry/arc.hpp"

/// Points along a curve as few moves of a robot.
namespace seampath {

struct PathPose {
    Eigen::Vector3d p;     ///< mm
    Eigen::Quaterniond q;  ///< unit
};

/// How far moves may leave the poses between their ends.
struct MoveTolerance {
    double distance_mm = 0;
    double angle_rad = 0;
};

/// A straight move to a pose, or a circular one through another on the way there.
struct PathMove {
    std::size_t end = 0;  ///< index of the pose
    std::optional<std::size_t> via;
};

/// How far one move is from the poses that it passes, and from the curve between them.
struct MoveError {
    double distance_mm = 0;
    double angle_rad = 0;  ///< from the rotation that turns evenly from the first pose to the last
};

/// Of a move from pose `from` through `via`, if any, to `to`; only at the poses themselves.
MoveError move_error(std::span<const PathPose> poses, std::size_t from, const PathMove& move);

/// The fewest moves, and among as many the fewest circular ones, that start in the first pose, end in the last, have
/// their ends and points on the way among the poses, and keep within the tolerance of every pose and of the curve half
/// way between neighbouring ones, which is the cubic through the nearest four. A straight move between neighbours is
/// always allowed. Circular moves turn by 5 to 175 deg, with radii up to 5 m: beyond that controllers are at odds with
/// each other. No move passes more than 120 poses. Time is linear in the number of poses.
std::vector<PathMove> fewest_moves(std::span<const PathPose> poses, const MoveTolerance& tolerance);

}  // namespace seampath
