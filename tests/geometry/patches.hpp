#pragma once

#include <cstdint>
#include <numbers>
#include <vector>

#include <Eigen/Core>

#include "datasets/rng.hpp"
#include "stages/geometry/surface_fit.hpp"

/// Points of whole surfaces, with noise.
namespace seampath {

inline constexpr double kDegree = std::numbers::pi / 180;

/// A piece of a surface, by two coordinates: mm along and across (plane), angle about the axis in rad and mm along it
/// (cylinder) or from the apex (cone), longitude and latitude in rad (sphere).
struct Patch {
    SurfaceFit::Shape shape;
    double a_from, a_to, b_from, b_to;
};

inline Eigen::Vector3d on(const Plane& s, double a, double b) {
    const Eigen::Vector3d e = s.normal.unitOrthogonal();
    return s.point + a * e + b * s.normal.cross(e);
}
inline Eigen::Vector3d about(const Eigen::Vector3d& axis, double a) {
    const Eigen::Vector3d e = axis.unitOrthogonal();
    return std::cos(a) * e + std::sin(a) * axis.cross(e);
}
inline Eigen::Vector3d on(const Cylinder& s, double a, double b) {
    return s.point + s.radius * about(s.axis, a) + b * s.axis;
}
inline Eigen::Vector3d on(const Cone& s, double a, double b) {
    return s.apex + b * (s.axis + std::tan(s.half_angle) * about(s.axis, a));
}
inline Eigen::Vector3d on(const Sphere& s, double a, double b) {
    return s.centre + s.radius * (std::cos(b) * about({0, 0, 1}, a) + std::sin(b) * Eigen::Vector3d::UnitZ());
}
inline Eigen::Vector3d on(const Patch& patch, double a, double b) {
    return std::visit([&](const auto& s) { return on(s, a, b); }, patch.shape);
}

/// Along the normal: noise of each point, noise that all points of a block share, and outliers, off to anywhere.
struct PatchNoise {
    double sigma = 0, shared = 0, outliers = 0;
    int blocks_a = 8, blocks_b = 4;
};

struct PatchPoints {
    std::vector<Eigen::Vector3d> points;
    std::vector<std::uint32_t> block;
    std::vector<Eigen::Vector3d> places, normals;  ///< normals that are off by some 0.02 rad
};

inline PatchPoints points_of(const Patch& patch, int count, const PatchNoise& noise, std::uint64_t seed) {
    constexpr double kOff = 2, kRough = 0.02;
    const Random place(seed, 0), own(seed, 1), shared(seed, 2), off(seed, 3), rough(seed, 4);
    const auto three = [](const Random& r, std::uint64_t i) {
        return Eigen::Vector3d(r.normal(3 * i), r.normal(3 * i + 1), r.normal(3 * i + 2));
    };
    PatchPoints made;
    for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(count); ++i) {
        const double x = place.uniform(2 * i), y = place.uniform(2 * i + 1);
        const Eigen::Vector3d p =
            on(patch, patch.a_from + x * (patch.a_to - patch.a_from), patch.b_from + y * (patch.b_to - patch.b_from));
        const Eigen::Vector3d n = std::visit([&](const auto& s) { return outward_normal(s, p); }, patch.shape);
        const auto block = static_cast<std::uint32_t>(x * noise.blocks_a) * static_cast<std::uint32_t>(noise.blocks_b) +
                           static_cast<std::uint32_t>(y * noise.blocks_b);
        made.points.push_back(p + (noise.sigma * own.normal(i) + noise.shared * shared.normal(block)) * n);
        made.block.push_back(block);
        if (i < noise.outliers * count) {
            made.points.back() += kOff * three(off, i).normalized();
        }
        if (i < 60) {
            made.places.push_back(p);
            made.normals.push_back((n + kRough * three(rough, i)).normalized());
        }
    }
    return made;
}

/// The same surface with the material on its other side.
inline void turn_inside_out(PatchPoints& made) {
    for (auto& n : made.normals) {
        n = -n;
    }
}

/// Fits the kind of surface that the patch is.
inline std::optional<SurfaceFit> fit_like(const SurfaceFit::Shape& shape, const PatchPoints& made,
                                          double least_scale = 0) {
    struct {
        const PatchPoints& m;
        double least;
        std::optional<SurfaceFit> operator()(const Plane&) const {
            return fit_plane(m.points, m.block, m.normals.front(), least);
        }
        std::optional<SurfaceFit> operator()(const Cylinder&) const {
            return fit_cylinder(m.points, m.block, m.places, m.normals, least);
        }
        std::optional<SurfaceFit> operator()(const Cone&) const {
            return fit_cone(m.points, m.block, m.places, m.normals, least);
        }
        std::optional<SurfaceFit> operator()(const Sphere&) const {
            return fit_sphere(m.points, m.block, m.places, m.normals, least);
        }
    } const fit{made, least_scale};
    return std::visit(fit, shape);
}

/// Largest distance of the fitted surface from the true one over the patch, mm.
inline double surface_error(const Patch& patch, const SurfaceFit& fit) {
    constexpr int kSteps = 20;
    double largest = 0;
    for (int i = 0; i <= kSteps; ++i) {
        for (int j = 0; j <= kSteps; ++j) {
            const Eigen::Vector3d p = on(patch, patch.a_from + i * (patch.a_to - patch.a_from) / kSteps,
                                         patch.b_from + j * (patch.b_to - patch.b_from) / kSteps);
            largest = std::max(largest, std::abs(fit.distance(p)));
        }
    }
    return largest;
}

}  // namespace seampath
