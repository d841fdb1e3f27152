#include "stages/mechanism/walk.hpp"

#include <cmath>
#include <limits>

namespace seampath::mechanism {

using Eigen::Vector2d;

GridSegment::GridSegment(const TwoTierGrid& grid, const Vector2d& M1, const Vector2d& M2)
    : grid_(grid), M1_(M1), M2_(M2) {
    const Vector2d along = (M2 - M1).normalized();
    normal_ = {-along.y(), along.x()};
}

double GridSegment::distance_from_line(const Vector2d& p) const {
    return std::abs(normal_.dot(p - M1_));
}

std::vector<GridNode> greedy_way(const GridSegment& segment, GridNode start, Neighbours neighbours) {
    std::vector<GridNode> nodes{start};
    while (true) {
        GridNode best;
        double least = std::numeric_limits<double>::infinity();
        segment.for_nearer_neighbours(nodes.back(), neighbours, [&](GridNode node, const Vector2d& p, double) {
            const double distance = segment.distance_from_line(p);
            if (distance < least) {
                least = distance;
                best = node;
            }
        });
        if (!std::isfinite(least)) {
            return nodes;
        }
        nodes.push_back(best);
    }
}

}  // namespace seampath::mechanism
