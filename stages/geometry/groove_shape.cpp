#include <algorithm>
#include <cmath>

#include "stages/angle.hpp"
#include "stages/geometry/densest.hpp"
#include "stages/geometry/groove_section.hpp"

namespace seampath {
namespace {

using Eigen::Vector2d;

constexpr double kFar = 60;    // mm, of a bevel
constexpr double kWidest = 5;  // mm from the root to a bevel
constexpr double kBegun = 6;   // spacings of a bevel that tell how dense its points are
constexpr std::size_t kFewest = 20;

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
                                       const std::array<Vector2d, 2>& normals, double back, double ahead) {
    const std::size_t one_view[] = {0};
    const GrooveBox box{{-kFar, -5}, {kFar, kFar}};
    const auto points = groove_points(grid, one_view, frame, -back, ahead, box);
    const double gate = 4 * scale.noise + scale.spacing;
    GrooveShape shape;
    for (std::size_t k = 0; k < 2; ++k) {
        const Vector2d& n = normals[k];
        const Vector2d up = k == 0 ? Vector2d(-n[1], n[0]) : Vector2d(n[1], -n[0]);
        // The root lies midway between the bevels: this one is as far off, along its normal, as most points say.
        std::vector<double> off, u;
        for (const GroovePoint& q : points) {
            const double along = up.dot(q.section()), away = n.dot(q.section());
            if (along > 0 && away < gate && away > -kWidest) {
                off.push_back(away);
            }
        }
        const Densest bevel = densest(std::move(off), gate);
        if (bevel.count < kFewest) {
            return std::nullopt;
        }
        const Vector2d foot = bevel.middle * n;
        for (const GroovePoint& q : points) {
            const Vector2d v = q.section() - foot;
            if (std::abs(n.dot(v)) < gate + 0.02 * up.dot(v) && up.dot(v) > 0) {
                u.push_back(up.dot(v));
            }
        }
        const double begin = quantile(u, 0.05);
        const auto end = density_edge(std::move(u), begin + kBegun * scale.spacing, scale.spacing, scale.noise);
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
