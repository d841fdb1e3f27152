#pragma once

#include "stages/robot_frames/robot_frames.hpp"

namespace seampath::robot_frames {

/// A profile of a ball as a circle in the laser's plane.
struct BallSection {
    Eigen::Vector2d centre;      ///< x, z, mm
    double radius = 0;           ///< mm
    Eigen::Matrix3d covariance;  ///< of centre and radius, mm^2
};

/// Least squares of the orthogonal distances; the covariance from how the points scatter. Throws InputError for fewer
/// than 10 points, points that make no circle, and a circle larger than the ball.
BallSection section_of(const BallProfile& profile, double ball_radius_mm);

}  // namespace seampath::robot_frames
