#pragma once

#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "datasets/rng.hpp"
#include "tests/geometry/clouds.hpp"

/// A box with sharp edges on a plate, as a scan and as the seam around it.
namespace seampath {

struct SharpBox {
    double length = 90, width = 60;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();

    std::vector<Eigen::Vector3d> corners() const {
        std::vector<Eigen::Vector3d> all;
        for (const auto& [x, y] : {std::pair{0.0, 0.0}, {length, 0.0}, {length, width}, {0.0, width}}) {
            all.emplace_back(pose * Eigen::Vector3d(x, y, 0));
        }
        return all;
    }

    /// From the sharp line around it.
    double distance(const Eigen::Vector3d& p) const {
        const Eigen::Vector3d q = pose.inverse() * p;
        const double x = std::max(-q.x(), q.x() - length), y = std::max(-q.y(), q.y() - width);
        const double across = x > 0 && y > 0 ? std::hypot(x, y) : std::abs(std::max(x, y));
        return std::hypot(across, q.z());
    }

    /// Its four walls, and the plate around.
    Scan scan(double sigma, std::uint64_t seed, double spacing = 0.3) const {
        constexpr double kHeight = 30, kPlate = 35;
        std::vector<Eigen::Vector3f> points;
        const Sampling sampling{spacing, sigma, seed};
        const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
        add_rectangle(points, {0, 0, 0}, x, length, z, kHeight, sampling);
        add_rectangle(points, {length, 0, 0}, y, width, z, kHeight, sampling);
        add_rectangle(points, {length, width, 0}, -x, length, z, kHeight, sampling);
        add_rectangle(points, {0, width, 0}, -y, width, z, kHeight, sampling);
        add_rectangle(points, {-kPlate, -kPlate, 0}, x, length + 2 * kPlate, y, kPlate, sampling);
        add_rectangle(points, {-kPlate, width, 0}, x, length + 2 * kPlate, y, kPlate, sampling);
        add_rectangle(points, {-kPlate, 0, 0}, x, kPlate, y, width, sampling);
        add_rectangle(points, {length, 0, 0}, x, kPlate, y, width, sampling);
        for (Eigen::Vector3f& p : points) {
            p = (pose * p.cast<double>()).cast<float>();
        }
        return scan_of_points(std::move(points));
    }

    /// Points along it, as extraction has them: about `spacing` apart, the plate's normal first.
    Seam seam(double spacing, double sigma, std::uint64_t seed) const {
        const Random random(seed, 1);
        const std::vector<Eigen::Vector3d> corner = corners();
        const Eigen::Vector3d up = pose.linear() * Eigen::Vector3d::UnitZ();
        Seam seam;
        seam.closed = true;
        std::uint64_t draw = 0;
        for (std::size_t side = 0; side < 4; ++side) {
            const Eigen::Vector3d& from = corner[side];
            const Eigen::Vector3d way = corner[(side + 1) % 4] - from;
            const Eigen::Vector3d out = way.cross(up).normalized();
            const auto steps = static_cast<int>(std::lround(way.norm() / spacing));
            for (int k = 0; k < steps; ++k) {
                const Eigen::Vector3d p = from + way * k / steps;
                if (k == 0) {
                    seam.corners.push_back(seam.points.size());
                    seam.points.push_back({p, up, out, 3 * sigma + 1e-3, false});
                    continue;
                }
                const double off_up = sigma / std::sqrt(2.0) * random.normal(draw++);
                const double off_out = sigma / std::sqrt(2.0) * random.normal(draw++);
                seam.points.push_back({p + off_up * up + off_out * out, up, out, std::max(sigma, 1e-3), false});
            }
        }
        return seam;
    }
};

inline SharpBox tilted_box() {
    SharpBox box;
    box.pose =
        Eigen::Translation3d(120, -40, 310) * Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.3, -0.5, 0.8).normalized());
    return box;
}

}  // namespace seampath
