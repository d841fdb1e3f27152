#include "stages/geometry/groove_points.hpp"

#include <algorithm>
#include <cmath>

namespace seampath {

GroovePoint unrolled(const GrooveFrame& frame, const Eigen::Vector3d& q, std::uint32_t view) {
    constexpr double kStraight = 1e-7;  // 1/mm
    const Eigen::Vector3d v = q - frame.p;
    const double k = frame.bend.norm(), x = v.dot(frame.t);
    double s = x;
    Eigen::Vector3d off = v - x * frame.t;
    if (k > kStraight) {
        const Eigen::Vector3d inwards = frame.bend / k, axis = frame.t.cross(inwards);
        const double radius = 1 / k, y = radius - v.dot(inwards);
        s = radius * std::atan2(x, y);
        off = (radius - std::hypot(x, y)) * inwards + v.dot(axis) * axis;
    }
    return {static_cast<float>(s), static_cast<float>(off.dot(frame.left())), static_cast<float>(off.dot(frame.up)),
            view};
}

std::vector<GroovePoint> groove_points(const PointGrid& grid, std::span<const std::size_t> view_starts,
                                       const GrooveFrame& frame, double back, double ahead, const GrooveBox& box) {
    Eigen::Vector3d low = Eigen::Vector3d::Constant(1e300), high = -low;
    for (const double s : {back, ahead}) {
        for (const double a : {box.low[0], box.high[0]}) {
            for (const double h : {box.low[1], box.high[1]}) {
                // The bend carries the box's far ends aside by half a square of s.
                for (const double bends : {0.0, 0.5 * s * s}) {
                    const Eigen::Vector3d corner = frame.at({a, h}) + s * frame.t + bends * frame.bend;
                    low = low.cwiseMin(corner);
                    high = high.cwiseMax(corner);
                }
            }
        }
    }
    // ... and turns them with it.
    const double turned = frame.bend.norm() * std::max(std::abs(back), std::abs(ahead)) *
                          std::max(box.low.cwiseAbs().maxCoeff(), box.high.cwiseAbs().maxCoeff());
    const double bent = frame.bend.norm() * 0.5 * std::max(back * back, ahead * ahead);
    low.array() -= turned;
    high.array() += turned;
    std::vector<GroovePoint> points;
    grid.for_cells_in_box(low, high, [&](std::size_t cell) {
        const auto in_cell = grid.points(cell);
        for (std::size_t i = 0; i < in_cell.size(); ++i) {
            const Eigen::Vector3d v = in_cell[i].cast<double>() - frame.p;
            const double straight = v.dot(frame.t), above = v.dot(frame.up);
            if (straight < back - turned || straight > ahead + turned || above < box.low[1] - turned - bent ||
                above > box.high[1] + turned + bent) {
                continue;
            }
            GroovePoint x = unrolled(frame, in_cell[i].cast<double>(), 0);
            if (x.s >= back && x.s <= ahead && (x.section().array() >= box.low.array()).all() &&
                (x.section().array() <= box.high.array()).all()) {
                const auto source = grid.source(grid.first_point(cell) + i);
                x.view = static_cast<std::uint32_t>(std::upper_bound(view_starts.begin(), view_starts.end(), source) -
                                                    view_starts.begin());
                points.push_back(x);
            }
        }
    });
    return points;
}

}  // namespace seampath
