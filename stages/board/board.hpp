#pragma once

#include <vector>

#include <Eigen/Core>

#include "stages/geometry/board.hpp"
#include "stages/geometry/grey_image.hpp"

/// Boards in pictures.
namespace seampath {

/// A point of the board and where it is seen.
struct SeenPoint {
    Eigen::Vector2d on_board;  ///< mm
    Eigen::Vector2d pixel;
};

/// The board's points in a picture, to a fraction of a pixel, by OpenCV: corners by findChessboardCornersSB (A. Duda
/// and U. Frese, BMVC 2018), circles by findCirclesGrid, each centre then the grey values' own, ChArUco corners by
/// their markers, ArUco markers by lines along their sides; markers may be hidden in part. Empty where the board is not
/// found. The board is dark on white; ChArUco boards are those of OpenCV before 4.6.1, with a dark square first. A
/// chessboard with both numbers even or both odd, and a grid of circles with an even number of rows, may be read from
/// the other end.
std::vector<SeenPoint> find_board(const GreyImage& image, const Board& board);

/// A marker's cells, row by row, border included; true is white. Throws InputError when the dictionary has none of that
/// number.
struct MarkerCells {
    int side = 0;
    std::vector<bool> white;
};
MarkerCells marker_cells(int dictionary, int number);

}  // namespace seampath
