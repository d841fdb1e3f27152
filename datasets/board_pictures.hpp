#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "stages/geometry/board.hpp"
#include "stages/geometry/camera.hpp"
#include "stages/geometry/grey_image.hpp"
#include "stages/geometry/quadric.hpp"

/// Pictures of flat boards with known cameras and places.
namespace seampath {

struct BoardLight {
    double white = 210;  ///< grey values
    double black = 30;
    double ground = 90;    ///< beside the board
    double blur_px = 0.7;  ///< 1-sigma of the lens
    double noise = 2;      ///< 1-sigma, grey values
};

/// The board as the camera sees it, area by area; bytes from the seed.
GreyImage draw_board(const Board& board, const CameraModel& camera, const Eigen::Isometry3d& camera_from_board,
                     const BoardLight& light, std::uint64_t seed);

/// Places of a board before a camera: over the whole picture, tilted to all sides by up to `tilt_deg`, from the seed.
std::vector<Eigen::Isometry3d> board_places(const Board& board, const CameraModel& camera, int count, double tilt_deg,
                                            std::uint64_t seed);

/// The laser's line on the board, px, in order along it: where the plane (camera's frame) meets the board.
std::vector<Eigen::Vector2d> line_on_board(const Board& board, const CameraModel& camera,
                                           const Eigen::Isometry3d& camera_from_board, const Plane& laser);

}  // namespace seampath
