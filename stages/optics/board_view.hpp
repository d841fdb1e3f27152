#pragma once

#include "stages/optics/optics.hpp"

namespace seampath::optics {

/// Where a point of a board is seen: a corner itself, or the middle of a circle's image, which is not the image of its
/// middle (the centroid of a polygon on it, which is exact without distortion).
Eigen::Vector2d sight_of(const CameraModel& camera, const Eigen::Isometry3d& camera_from_board,
                         const Eigen::Vector2d& on_board, double circle_radius_mm);

/// Distances of a view's points in the picture, two a point.
Eigen::VectorXd residuals_of(const CameraModel& camera, const Eigen::Isometry3d& camera_from_board,
                             const std::vector<BoardSight>& points, double circle_radius_mm);

/// Units of a pose's step for derivatives.
Eigen::VectorXd pose_unit();

/// A camera without distortion, and places of the boards, to begin with (OpenCV: closed forms of Zhang and of the
/// homography).
CameraModel first_camera(const std::vector<BoardView>& views, int width, int height);
Eigen::Isometry3d first_place(const CameraModel& camera, const BoardView& view);

/// The place of the board by least squares from a start. `least_variance`: of a pixel, px^2, where the residuals say
/// less.
BoardPlace refined_place(const CameraModel& camera, const BoardView& view, const Eigen::Isometry3d& start,
                         double circle_radius_mm, double least_variance = 0);

/// Throws InputError for a view of fewer than 6 points.
void check_points(const BoardView& view);

}  // namespace seampath::optics
