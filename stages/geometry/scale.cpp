#include "stages/geometry/scale.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <vector>

#include <Eigen/Dense>

#include "stages/geometry/grid.hpp"
#include "stages/geometry/parallel.hpp"
#include "stages/geometry/robust.hpp"

namespace seampath {
namespace {

constexpr std::size_t kPlaces = 400;       // the median of so many is stable to a few per cent
constexpr std::size_t kNeighbours = 16;

// Extent of the bulk of the points: stray returns metres away must not set the first cell size.
double robust_extent(std::span<const Eigen::Vector3f> points) {
    const std::size_t stride = std::max<std::size_t>(1, points.size() / 4096);
    double extent = 0;
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<double> x;
        for (std::size_t i = 0; i < points.size(); i += stride) {
            x.push_back(points[i][axis]);
        }
        const double low = quantile(x, 0.02), high = quantile(x, 0.98);
        extent = std::max(extent, high - low);
    }
    return extent;
}

// Distance of the k-th neighbour; the ball grows until it holds enough points.
double neighbour_distance(const PointGrid& grid, const Eigen::Vector3d& p, double limit) {
    std::vector<double> d2;
    for (double radius = grid.cell() / 4; radius <= limit; radius *= 2) {
        d2.clear();
        grid.for_points_in_ball(p, radius, [&](const Eigen::Vector3f&, double squared) { d2.push_back(squared); });
        if (d2.size() > kNeighbours) {
            std::nth_element(d2.begin(), d2.begin() + kNeighbours, d2.end());
            return std::sqrt(d2[kNeighbours]);
        }
    }
    return limit;
}

// Robust scale of the residuals of a quadric over the best-fit plane of a ball; negative when it holds too little.
double roughness(const PointGrid& grid, const Eigen::Vector3d& p, double radius) {
    std::vector<Eigen::Vector3d> q;
    grid.for_points_in_ball(p, radius, [&](const Eigen::Vector3f& x, double) { q.push_back(x.cast<double>() - p); });
    if (q.size() < 20) {
        return -1;
    }
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const auto& x : q) {
        mean += x;
    }
    mean /= static_cast<double>(q.size());
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const auto& x : q) {
        scatter += (x - mean) * (x - mean).transpose();
    }
    const Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors();
    QuadraticFit fit;
    fit.begin(q.size());
    for (const auto& x : q) {
        const Eigen::Vector3d local = axes.transpose() * (x - mean) / radius;
        fit.add(local[1], local[2], local[0] * radius);
    }
    return fit.solve(0) ? fit.scale() : -1;
}

}  // namespace

ScanScale estimate_scale(std::span<const Eigen::Vector3f> points) {
    ScanScale scale;
    const double extent = points.size() < 50 ? 0 : robust_extent(points);
    if (extent <= 0) {
        return scale;
    }
    const PointGrid grid(points, extent / 128);
    std::vector<Eigen::Vector3d> places;
    for (std::size_t k = 0; k < kPlaces; ++k) {
        // Through the points in the order of space, so that the choice does not hang on the order of the file.
        places.push_back(grid.mean((2 * k + 1) * grid.cells() / (2 * kPlaces)));
    }
    std::vector<double> spacing(places.size());
    parallel_for(places.size(), 16, [&](std::size_t k) {
        spacing[k] = neighbour_distance(grid, places[k], extent) * std::sqrt(std::numbers::pi / kNeighbours);
    });
    scale.spacing = quantile(spacing, 0.5);
    double radius = 6 * scale.spacing;
    for (int round = 0; round < 4; ++round) {
        std::vector<double> noise(places.size());
        parallel_for(places.size(), 16, [&](std::size_t k) { noise[k] = roughness(grid, places[k], radius); });
        std::erase_if(noise, [](double x) { return x < 0; });
        // Places on edges are rough for another reason: look below the median.
        scale.noise = noise.empty() ? 0 : quantile(noise, 0.4);
        if (6 * scale.noise <= radius) {
            break;
        }
        radius = 8 * scale.noise;      // where noise exceeds the spacing a wider ball is needed to see a surface
    }
    return scale;
}

}  // namespace seampath
