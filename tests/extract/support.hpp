#pragma once

#include <algorithm>
#include <optional>

#include "stages/extract/extract.hpp"
#include "tests/geometry/clouds.hpp"

/// Scans with joints, and distances between seams.
namespace seampath {

/// A corner along the x axis, 0.045 mm noise, 0.3 mm pitch.
inline Scan corner_scan(double length = 80, double sigma = 0.045) {
    std::vector<Eigen::Vector3f> points;
    add_corner(points, length, 30, {0.3, sigma, 1});
    return scan_of_points(std::move(points));
}

inline double length_of(const Seam& seam) {
    double length = 0;
    for (std::size_t i = 1; i < seam.points.size(); ++i) {
        length += (seam.points[i].p - seam.points[i - 1].p).norm();
    }
    return length;
}

/// The seam with a point between every two, on the cubic through the four around them: chords of 0.8 mm cut 0.003 mm
/// off a bend of 30 mm radius.
inline Seam with_points_between(const Seam& seam) {
    Seam finer = seam;
    finer.points.clear();
    const std::size_t n = seam.points.size();
    for (std::size_t i = 0; i < n; ++i) {
        finer.points.push_back(seam.points[i]);
        const bool has_four = seam.closed || (i > 0 && i + 2 < n);
        if (has_four) {
            const auto p = [&](std::size_t k) { return seam.points[(i + n + k - 1) % n].p; };
            finer.points.push_back(seam.points[i]);
            finer.points.back().p = (9 * (p(1) + p(2)) - p(0) - p(3)) / 16;
        }
    }
    return finer;
}

/// Distance of p from the polyline of a seam; nothing beyond its open ends.
inline std::optional<double> distance_across(const Seam& seam, const Eigen::Vector3d& p) {
    double nearest = 1e300;
    bool nearest_is_end = false;
    const std::size_t n = seam.points.size();
    for (std::size_t i = 0; i + (seam.closed ? 0 : 1) < n; ++i) {
        const Eigen::Vector3d a = seam.points[i].p, step = seam.points[(i + 1) % n].p - a;
        const double x = (p - a).dot(step) / step.squaredNorm();
        const double d = (p - a - std::clamp(x, 0.0, 1.0) * step).norm();
        if (d < nearest) {
            nearest = d;
            nearest_is_end = !seam.closed && ((i == 0 && x < 0) || (i + 2 == n && x > 1));
        }
    }
    return nearest_is_end ? std::nullopt : std::optional(nearest);
}

}  // namespace seampath
