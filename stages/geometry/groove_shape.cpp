#include <algorithm>
#include <cmath>

#include "stages/angle.hpp"
#include "stages/geometry/groove_section.hpp"

namespace seampath {
namespace {

using Eigen::Vector2d;

constexpr double kFar = 60;  // mm, of a bevel
constexpr double kHalf = 4;  // mm of the groove that are looked at, each way

// The direction, out of the groove, of the line through the corner on which most points lie.
Vector2d top_beside(std::span<const GroovePoint> points, const Vector2d& corner, const Vector2d& bevel, double turn,
                    double gate, double reach) {
    Vector2d best = bevel;
    double most = -1;
    for (double angle = 20 * kDegree; angle < 160 * kDegree; angle += 3 * kDegree) {
        const double c = std::cos(angle), s = turn * std::sin(angle);
        const Vector2d out(c * bevel[0] - s * bevel[1], s * bevel[0] + c * bevel[1]);
        double count = 0;
        for (const GroovePoint& q : points) {
            const Vector2d v = q.section() - corner;
            const double u = out.dot(v);
            count += u > 0.15 * reach && u < reach && std::abs(out[0] * v[1] - out[1] * v[0]) < gate + 0.03 * u;
        }
        if (count > most) {
            most = count;
            best = out;
        }
    }
    return best;
}

}  // namespace

std::optional<GrooveShape> shape_about(const PointGrid& grid, const ScanScale& scale, const GrooveFrame& frame,
                                       const std::array<Vector2d, 2>& normals) {
    const std::size_t one_view[] = {0};
    const GrooveBox box{{-kFar, -5}, {kFar, kFar}};
    const auto points = groove_points(grid, one_view, frame, -kHalf, kHalf, box);
    const double gate = 4 * scale.noise + scale.spacing;
    GrooveShape shape;
    for (std::size_t k = 0; k < 2; ++k) {
        const Vector2d& n = normals[k];
        const Vector2d up = k == 0 ? Vector2d(-n[1], n[0]) : Vector2d(n[1], -n[0]);
        // The root lies midway between the bevels: this one is as far off, along its normal, as most points say.
        std::vector<double> off, u;
        for (const GroovePoint& q : points) {
            const double along = up.dot(q.section()), away = n.dot(q.section());
            if (along > 3 * scale.spacing && along < 20 * scale.spacing && away < gate && away > -5) {
                off.push_back(away);
            }
        }
        if (off.size() < 20) {
            return std::nullopt;
        }
        const Vector2d foot = quantile(off, 0.5) * n;
        for (const GroovePoint& q : points) {
            const Vector2d v = q.section() - foot;
            if (std::abs(n.dot(v)) < gate + 0.02 * up.dot(v) && up.dot(v) > 0) {
                u.push_back(up.dot(v));
            }
        }
        const auto end = density_edge(std::move(u), 12 * scale.spacing, 2 * scale.spacing, scale.noise);
        if (!end) {
            return std::nullopt;
        }
        shape.end[k] = foot;
        shape.corner[k] = foot + end->at * up;
        shape.out[k] = top_beside(points, shape.corner[k], up, k == 0 ? 1 : -1, gate, 30 * scale.spacing);
    }
    return shape;
}

}  // namespace seampath
