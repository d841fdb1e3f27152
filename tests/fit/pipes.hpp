#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "stages/geometry/quadric.hpp"
#include "tests/geometry/clouds.hpp"

/// Scans of a pipe that stands on a plate or on another pipe, put together from views all round.
namespace seampath {

struct PipeScene {
    double radius = 15;
    std::optional<double> header_radius;  ///< none: a plate
    double lean = 0.25;                   ///< rad, of the branch from the upright, along the header
    double offset = 0;                    ///< mm, between the axes
    double ovality = 0;                   ///< mm, largest less least diameter of the branch
    int views = 4;
    double registration = 0;  ///< mm, 1-sigma of each view's shift along each axis
    Sampling sampling{0.6, 0.045, 1};
};

/// The plate is z = 0, its material below; the header's axis runs along y, its top is z = 0.
inline Cylinder branch_of(const PipeScene& s) {
    return {{s.offset, 0, 0}, {0, std::sin(s.lean), std::cos(s.lean)}, s.radius};
}
inline double above_header(const PipeScene& s, const Eigen::Vector3d& p) {
    return s.header_radius ? std::hypot(p.x(), p.z() + *s.header_radius) - *s.header_radius : p.z();
}
inline Eigen::Vector3d on_branch(const PipeScene& s, double angle, double along) {
    const Cylinder b = branch_of(s);
    const Eigen::Vector3d e0 = Eigen::Vector3d::UnitX(), e1 = b.axis.cross(e0);
    const double r = b.radius + s.ovality / 4 * std::cos(2 * angle);
    return b.point + along * b.axis + r * (std::cos(angle) * e0 + std::sin(angle) * e1);
}
inline bool outside_branch(const PipeScene& s, const Eigen::Vector3d& p) {
    const Cylinder b = branch_of(s);
    const Eigen::Vector3d w = across(p - b.point, b.axis), e0 = Eigen::Vector3d::UnitX();
    const double angle = std::atan2(w.dot(b.axis.cross(e0)), w.dot(e0));
    return w.norm() > b.radius + s.ovality / 4 * std::cos(2 * angle);
}

/// The true seam: where the branch's generator line at each angle leaves the header, by bisection.
inline Eigen::Vector3d seam_point(const PipeScene& s, double angle) {
    const double reach = s.radius + s.header_radius.value_or(0);
    double below = -reach, above = reach;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (below + above);
        (above_header(s, on_branch(s, angle, middle)) < 0 ? below : above) = middle;
    }
    return on_branch(s, angle, above);
}

/// What one view sees of both walls, row by row as a scanner, from one end of the header to the other.
inline std::vector<Eigen::Vector3d> view_of(const PipeScene& s, int view) {
    constexpr double kHeight = 14, kMargin = 14, kLeastCosine = 0.15;
    const double pitch = s.sampling.pitch, from = 2 * std::numbers::pi * (view + 0.3) / s.views;
    const Eigen::Vector3d to_camera = Eigen::Vector3d(std::cos(from), std::sin(from), 0.8).normalized();
    const Random random(s.sampling.seed, static_cast<std::uint64_t>(1 + view));
    std::uint64_t draw = 0;
    std::vector<Eigen::Vector3d> points;
    const auto add = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& normal) {
        if (normal.dot(to_camera) > kLeastCosine) {
            points.push_back(p + s.sampling.sigma * random.normal(draw) * normal);
        }
        ++draw;
    };
    const auto jitter = [&] { return pitch * random.uniform(draw++, -0.5, 0.5); };
    const Cylinder branch = branch_of(s);
    for (double a = 0; a < 2 * std::numbers::pi; a += pitch / s.radius) {
        for (double u = 0; u < kHeight; u += pitch) {
            const double angle = a + jitter() / s.radius,
                         start = (seam_point(s, angle) - branch.point).dot(branch.axis);
            const Eigen::Vector3d p = on_branch(s, angle, start + u + jitter());
            if (above_header(s, p) > 0) {
                add(p, outward_normal(branch, p));
            }
        }
    }
    const double half = s.radius + kMargin;
    for (double x = -half; x < half; x += pitch) {
        for (double y = -half; y < half; y += pitch) {
            const double v = y + jitter(), w = x + jitter();
            Eigen::Vector3d p(w, v, 0), normal = Eigen::Vector3d::UnitZ();
            if (s.header_radius) {
                const double angle = w / *s.header_radius;
                normal = {std::sin(angle), 0, std::cos(angle)};
                p = *s.header_radius * normal + Eigen::Vector3d(0, v, -*s.header_radius);
            }
            if (outside_branch(s, p)) {
                add(p, normal);
            }
        }
    }
    std::stable_sort(points.begin(), points.end(), [&](const auto& a, const auto& b) {
        return std::floor(a.y() / pitch) < std::floor(b.y() / pitch);
    });
    return points;
}

inline Scan scan_of(const PipeScene& s) {
    std::vector<Eigen::Vector3f> points;
    const Random random(s.sampling.seed, 0);
    for (int view = 0; view < s.views; ++view) {
        const std::uint64_t draw = 3 * static_cast<std::uint64_t>(view);
        const Eigen::Vector3d shift =
            s.registration * Eigen::Vector3d(random.normal(draw), random.normal(draw + 1), random.normal(draw + 2));
        for (const Eigen::Vector3d& p : view_of(s, view)) {
            points.push_back((p + shift).cast<float>());
        }
    }
    return scan_of_points(std::move(points));
}

}  // namespace seampath
