#pragma once

#include <array>
#include <string_view>
#include <vector>

#include <Eigen/Core>

/// Flat boards for cameras. A board's frame has its origin at the first point, x along a row, y down the columns and z
/// away from who looks at its face.
namespace seampath {

/// Circles are in an asymmetric grid, every other row moved by half their distance: a symmetric one looks the same from
/// its other end.
enum class BoardKind { chessboard, charuco, circles, aruco };
inline constexpr std::array<std::string_view, 4> kBoardKindNames{"chessboard", "charuco", "circles", "aruco"};

/// Dictionaries of OpenCV's ArUco markers, in the order of its enumeration: bits a side, number of markers.
inline constexpr std::array<std::string_view, 16> kMarkerDictionaryNames{
    "4x4_50", "4x4_100", "4x4_250", "4x4_1000", "5x5_50", "5x5_100", "5x5_250", "5x5_1000",
    "6x6_50", "6x6_100", "6x6_250", "6x6_1000", "7x7_50", "7x7_100", "7x7_250", "7x7_1000"};

struct Board {
    BoardKind kind = BoardKind::chessboard;
    int columns = 0;  ///< inner corners, squares (ChArUco), circles or markers (ArUco) of each row
    int rows = 0;
    double pitch_mm = 0;   ///< side of a square, distance of markers, or of the rows of circles, half that in a row
    double size_mm = 0;    ///< diameter of a circle, or side of a marker; unused by a chessboard
    int dictionary = 0;    ///< index of kMarkerDictionaryNames
    int first_marker = 0;  ///< number of the first marker (ArUco); the others follow row by row
};

/// The points that are found on it, row by row from the first, mm: inner corners, centres of circles, or the four
/// corners of each marker, clockwise from its first.
std::vector<Eigen::Vector2d> points_of(const Board& board);

}  // namespace seampath
