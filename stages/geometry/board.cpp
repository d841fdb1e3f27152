#include "stages/geometry/board.hpp"

namespace seampath {

std::vector<Eigen::Vector2d> points_of(const Board& board) {
    const int less = board.kind == BoardKind::charuco ? 1 : 0;  // squares have one inner corner less
    std::vector<Eigen::Vector2d> points;
    for (int row = 0; row < board.rows - less; ++row) {
        for (int column = 0; column < board.columns - less; ++column) {
            if (board.kind == BoardKind::aruco) {
                for (const Eigen::Vector2d& corner :
                     {Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 0), Eigen::Vector2d(1, 1), Eigen::Vector2d(0, 1)}) {
                    points.push_back(board.pitch_mm * Eigen::Vector2d(column, row) + board.size_mm * corner);
                }
                continue;
            }
            const bool circles = board.kind == BoardKind::circles;
            points.emplace_back(board.pitch_mm * (circles ? 2 * column + row % 2 : column), board.pitch_mm * row);
        }
    }
    return points;
}

}  // namespace seampath
