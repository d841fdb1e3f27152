#include "stages/geometry/groove_turn.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

namespace seampath {

using Eigen::Vector2d;

std::optional<BevelDepth> bevel_turn(std::span<const GroovePoint> points, const Vector2d& drift, const GrooveFit& fit,
                                     std::size_t side, const Vector2d& end, const ScanScale& scale, double gate) {
    constexpr double kReach = 1.5;  // mm down the root face
    constexpr std::size_t kFewestOnFace = 8;
    constexpr double kOverStrays = 3;       // points of the face, over those in as wide a strip of air beside it
    constexpr double kRough = 2.5;          // noises
    constexpr std::size_t kFewestRows = 5;  // along the groove: the plate's end face is seen in one
    const Vector2d out = fit.top[side].tangent(0), up_bevel = fit.bevel[side].tangent(fit.bevel[side].along(end));
    Vector2d down(out[1], -out[0]);
    down *= down.dot(up_bevel) > 0 ? -1 : 1;
    const double sine = up_bevel.dot(out), cosine = -up_bevel.dot(down);
    if (sine < std::sin(kSquareSide)) {
        return std::nullopt;
    }
    const double inward = 4 * scale.noise, outward = gate + 4 * scale.noise, width = inward + outward;
    std::vector<double> lateral;
    std::set<long> rows;
    std::size_t strays = 0;
    for (const GroovePoint& q : points) {
        const Vector2d v = q.section(drift) - end;
        const double l = v.dot(out), w = v.dot(down);
        if (w > 2 * scale.noise && w < kReach && l > -inward - width && l < outward) {
            if (l > -inward) {
                lateral.push_back(l);
                rows.insert(std::lround(q.s / scale.spacing));
            } else {
                ++strays;
            }
        }
    }
    if (rows.size() < kFewestRows ||
        lateral.size() < std::max<double>(kFewestOnFace, kOverStrays * static_cast<double>(strays))) {
        return std::nullopt;
    }
    const double middle = quantile(lateral, 0.5);
    std::vector<double> off;
    for (const double l : lateral) {
        off.push_back(std::abs(l - middle));
    }
    const double scatter = 1.4826 * quantile(off, 0.5);
    if (scatter > kRough * scale.noise) {
        return std::nullopt;
    }
    // The 1-sigma of a median, and no better than a tenth of the noise.
    const double sigma = std::max(0.1 * scale.noise,
                                  1.25 * scatter * std::sqrt(scale.correlation / static_cast<double>(lateral.size())));
    const double depth = std::abs(cross(out, fit.shape.corner[side] - end));
    return BevelDepth{depth - middle * cosine / sine, sigma * cosine / sine, {}, true};
}

}  // namespace seampath
