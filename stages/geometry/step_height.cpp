#include "stages/geometry/step_height.hpp"

#include <cmath>
#include <vector>

#include "stages/geometry/robust.hpp"

namespace seampath {

std::optional<double> step_height(const PointGrid& grid, const ScanScale& scale, const Eigen::Vector3d& p,
                                  const Eigen::Vector3d& n1, const Eigen::Vector3d& n2) {
    constexpr double kMostHeight = 40, kNear = 3, kFar = 15;  // mm; point distances behind the wall
    constexpr std::size_t kLeast = 20;
    const Eigen::Vector3d t = n1.cross(n2).normalized(), back = n1.cross(t);
    const double half = kFar * scale.spacing;
    const Eigen::Vector3d middle = p + 0.5 * kMostHeight * n1;
    const Eigen::Vector3d box = 0.5 * kMostHeight * n1.cwiseAbs() + Eigen::Vector3d::Constant(half);
    std::vector<double> heights;
    grid.for_cells_in_box(middle - box, middle + box, [&](std::size_t cell) {
        for (const Eigen::Vector3f& q : grid.points(cell)) {
            const Eigen::Vector3d v = q.cast<double>() - p;
            const double behind = v.dot(back), z = v.dot(n1);
            if (std::abs(v.dot(t)) < half && behind > kNear * scale.spacing && behind < half && z > 4 * scale.noise &&
                z < kMostHeight) {
                heights.push_back(z);
            }
        }
    });
    return heights.size() < kLeast ? std::nullopt : std::optional(quantile(heights, 0.5));
}

}  // namespace seampath
