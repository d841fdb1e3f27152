#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "datasets/rng.hpp"
#include "stages/types.hpp"

/// Scans of simple surfaces, point by point.
namespace seampath {

/// Spacing and white noise of a made surface.
struct Sampling {
    double pitch = 0.3;
    double sigma = 0;
    std::uint64_t seed = 1;
};

/// Points of the rectangle corner + x a + y b, with x in [0, length_a] and y in [0, length_b], on a jittered raster.
inline void add_rectangle(std::vector<Eigen::Vector3f>& points, const Eigen::Vector3d& corner, const Eigen::Vector3d& a,
                          double length_a, const Eigen::Vector3d& b, double length_b, const Sampling& sampling) {
    const Random random(sampling.seed, points.size());
    const Eigen::Vector3d normal = a.cross(b).normalized();
    std::uint64_t i = 0;
    for (double x = sampling.pitch / 2; x < length_a; x += sampling.pitch) {
        for (double y = sampling.pitch / 2; y < length_b; y += sampling.pitch, ++i) {
            const double dx = sampling.pitch * random.uniform(8 * i, -0.5, 0.5),
                         dy = sampling.pitch * random.uniform(8 * i + 1, -0.5, 0.5);
            points.push_back((corner + (x + dx) * a + (y + dy) * b + sampling.sigma * random.normal(4 * i + 1) * normal)
                                 .cast<float>());
        }
    }
}

/// Points of a cylinder about the z axis through the origin, z in [0, height], outside.
inline void add_cylinder(std::vector<Eigen::Vector3f>& points, double radius, double height, const Sampling& sampling,
                         double from = 0, double to = 6.283185307179586) {
    const Random random(sampling.seed, points.size());
    std::uint64_t i = 0;
    for (double a = from + sampling.pitch / radius / 2; a < to; a += sampling.pitch / radius) {
        for (double z = sampling.pitch / 2; z < height; z += sampling.pitch, ++i) {
            const double angle = a + sampling.pitch / radius * random.uniform(8 * i, -0.5, 0.5);
            const double r = radius + sampling.sigma * random.normal(4 * i + 1);
            points.emplace_back(static_cast<float>(r * std::cos(angle)), static_cast<float>(r * std::sin(angle)),
                                static_cast<float>(z + sampling.pitch * random.uniform(8 * i + 1, -0.5, 0.5)));
        }
    }
}

/// An inner corner along the x axis from 0 to `length`: floor z = 0 over y in [0, width], wall y = 0 over z in [0,
/// width].
inline void add_corner(std::vector<Eigen::Vector3f>& points, double length, double width, const Sampling& sampling) {
    add_rectangle(points, {0, 0, 0}, Eigen::Vector3d::UnitX(), length, Eigen::Vector3d::UnitY(), width, sampling);
    add_rectangle(points, {0, 0, 0}, Eigen::Vector3d::UnitX(), length, Eigen::Vector3d::UnitZ(), width, sampling);
}

inline Scan scan_of_points(std::vector<Eigen::Vector3f> points) {
    Scan scan;
    scan.name = "made";
    scan.points = std::move(points);
    scan.points_in_file = scan.points.size();
    return scan;
}

}  // namespace seampath
