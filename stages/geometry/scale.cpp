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

// A quadric over the best-fit plane of a ball.
struct Patch {
    bool valid = false;
    double scale = 0;      // robust 1-sigma of the residuals
    double between = 0;    // squares of sums over blocks of 0.36 radii, added up
    double within = 0;     // squares of the same residuals, added up
};

Patch fit_patch(const PointGrid& grid, const Eigen::Vector3d& p, double radius) {
    std::vector<Eigen::Vector3d> q;
    grid.for_points_in_ball(p, radius, [&](const Eigen::Vector3f& x, double) { q.push_back(x.cast<double>() - p); });
    if (q.size() < 20) {
        return {};
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
    if (!fit.solve(0)) {
        return {};
    }
    Patch patch{true, fit.scale(), 0, 0};
    constexpr int kBlocks = 6;      // across the ball: wide enough to hold the range of the correlation, enough to average
    std::array<double, static_cast<std::size_t>(kBlocks* kBlocks)> sum{};
    double blocks = 0;
    for (std::size_t i = 0; i < fit.size(); ++i) {
        const auto column = [](double x) { return std::clamp(static_cast<int>((x + 1) / 2 * kBlocks), 0, kBlocks - 1); };
        const double r = fit.weight(i) > 0 ? fit.residual(i) : 0;
        double& block = sum[static_cast<std::size_t>(column(fit.u(i)) * kBlocks + column(fit.s(i)))];
        blocks += block == 0 && r != 0;
        block += r;
        patch.within += r * r;
    }
    for (const double s : sum) {
        patch.between += s * s;
    }
    // Six coefficients took their share of what the blocks have in common.
    patch.between *= blocks > 12 ? blocks / (blocks - 6) : 0;
    return patch;
}

std::vector<Patch> fit_patches(const PointGrid& grid, const std::vector<Eigen::Vector3d>& places, double radius) {
    std::vector<Patch> patches(places.size());
    parallel_for(places.size(), 16, [&](std::size_t k) { patches[k] = fit_patch(grid, places[k], radius); });
    std::erase_if(patches, [](const Patch& patch) { return !patch.valid; });
    return patches;
}

// Places on edges are rough for another reason: look below the median.
double typical_scale(const std::vector<Patch>& patches) {
    std::vector<double> scales;
    for (const Patch& patch : patches) {
        scales.push_back(patch.scale);
    }
    return quantile(scales, 0.4);
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
        scale.noise = typical_scale(fit_patches(grid, places, radius));
        if (6 * scale.noise <= radius) {
            break;
        }
        radius = 8 * scale.noise;      // where noise exceeds the spacing a wider ball is needed to see a surface
    }
    // Correlated noise shows over more than its own range: wider balls, and of those the ones that are still smooth. What
    // such a ball sees as noise is also less biased than what a small one leaves.
    std::vector<Eigen::Vector3d> fewer;
    for (std::size_t k = 0; k < places.size(); k += 2) {
        fewer.push_back(places[k]);
    }
    const std::vector<Patch> wide = fit_patches(grid, fewer, 4.5 * radius);
    const double smooth = 1.3 * typical_scale(wide);
    std::vector<double> smooth_scales;
    double between = 0, within = 0;
    for (const Patch& patch : wide) {
        if (patch.scale <= smooth) {
            smooth_scales.push_back(patch.scale);
            between += patch.between;
            within += patch.within;
        }
    }
    // On a part with no smooth place of that size the smaller balls have to do.
    const double wide_noise = quantile(smooth_scales, 0.5);
    if (within > 0 && wide_noise < 2 * scale.noise) {
        scale.noise = std::max(scale.noise, wide_noise);
        scale.correlation = std::clamp(between / within, 1.0, 60.0);
    }
    return scale;
}

}  // namespace seampath
