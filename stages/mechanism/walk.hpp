#pragma once

#include <vector>

#include "stages/mechanism/mechanism.hpp"

/// Private to the mechanism: one straight segment on the grid, and the greedy way along it.
namespace seampath::mechanism {

enum class Neighbours { four, eight };

/// The segment M1 M2, which has a length, over a grid.
class GridSegment {
public:
    GridSegment(const TwoTierGrid& grid, const Eigen::Vector2d& M1, const Eigen::Vector2d& M2);

    const TwoTierGrid& grid() const { return grid_; }
    double distance_from_line(const Eigen::Vector2d& p) const;  ///< perpendicular, mm
    double distance_to_end(const Eigen::Vector2d& p) const { return (p - M2_).norm(); }

    /// Calls visit(node, position, distance to M2) for each neighbour of `node` that is nearer to M2 than it.
    template <class Visit>
    void for_nearer_neighbours(GridNode node, Neighbours neighbours, const Visit& visit) const;

private:
    TwoTierGrid grid_;
    Eigen::Vector2d M1_, M2_, normal_;
};

/// Of the nearer neighbours always the one least far from the line, until there is none.
std::vector<GridNode> greedy_way(const GridSegment& segment, GridNode start, Neighbours neighbours);

template <class Visit>
void GridSegment::for_nearer_neighbours(GridNode node, Neighbours neighbours, const Visit& visit) const {
    // Nearer by more than rounding, so that two nodes at the same distance are no way to each other.
    const double limit = distance_to_end(seampath::position(grid_, node)) - 1e-12 * grid_.radius_mm;
    const int n = grid_.alpha_steps;
    const auto offer = [&](int i, int j) {
        const GridNode next{(i + n) % n, j};
        const Eigen::Vector2d p = seampath::position(grid_, next);
        const double to_end = distance_to_end(p);
        if (to_end < limit) {
            visit(next, p, to_end);
        }
    };
    if (node.j == 0) {
        for (int i = 0; i < n; ++i) {
            offer(i, 1);
        }
        return;
    }
    for (int dj = -1; dj <= 1; ++dj) {
        const int j = node.j + dj;
        if (j < 0 || j > grid_.beta_steps) {
            continue;
        }
        if (j == 0) {
            offer(node.i, 0);  // the centre once, whatever alpha
            continue;
        }
        for (int di = -1; di <= 1; ++di) {
            const bool itself = di == 0 && dj == 0, diagonal = di != 0 && dj != 0;
            if (!itself && !(diagonal && neighbours == Neighbours::four)) {
                offer(node.i + di, j);
            }
        }
    }
}

}  // namespace seampath::mechanism
