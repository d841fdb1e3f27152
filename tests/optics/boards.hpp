#pragma once

#include "datasets/fixtures/board_pictures.hpp"
#include "datasets/fixtures/fixture_draws.hpp"
#include "stages/optics/optics.hpp"

/// A camera and boards that the tests of cameras and lasers share.
namespace seampath::test {

inline CameraModel wide_camera() {
    return {1280, 960, {1500, 1497}, {642.5, 476}, {-0.12, 0.08, 0.0004, -0.0003, 0}};
}
inline CameraModel small_camera() {
    return {640, 480, {750, 748.5}, {321, 238}, {-0.12, 0.08, 0.0004, -0.0003, 0}};
}
inline Board corners() {
    return {BoardKind::chessboard, 11, 8, 15, 0, 0};
}

/// What the camera sees of the board's points, with errors of so many pixels along each axis.
inline BoardView seen(const Board& board, const CameraModel& camera, const Eigen::Isometry3d& place, double sigma_px,
                      std::uint64_t seed) {
    Draws draws(seed, 4711);
    BoardView view{"view", {}};
    for (const Eigen::Vector2d& p : points_of(board)) {
        const double x = draws.normal(), y = draws.normal();
        const Eigen::Vector2d pixel = pixel_of(camera, place * Eigen::Vector3d(p.x(), p.y(), 0));
        view.points.push_back({p, pixel + sigma_px * Eigen::Vector2d(x, y)});
    }
    return view;
}

}  // namespace seampath::test
