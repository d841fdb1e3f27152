#include "stages/geometry/bulk.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "stages/geometry/parallel.hpp"

namespace seampath {
namespace {

struct Box {
    Eigen::Vector3d low = Eigen::Vector3d::Constant(-std::numeric_limits<double>::max()), high = -low;
    bool holds(const Eigen::Vector3d& x) const {
        return (x.array() >= low.array()).all() && (x.array() <= high.array()).all();
    }
};

struct Moments {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero(), squares = Eigen::Vector3d::Zero();
    double count = 0;
};

// Of the points in the box, about `middle`.
Moments moments_of(std::span<const Eigen::Vector3f> points, const Box& box, const Eigen::Vector3d& middle) {
    std::array<Moments, 16> chunk;
    parallel_chunks(points.size(), chunk.size(), [&](std::size_t c, std::size_t begin, std::size_t end) {
        Moments m;
        for (std::size_t i = begin; i < end; ++i) {
            const Eigen::Vector3d x = points[i].cast<double>();
            if (box.holds(x)) {
                const Eigen::Vector3d d = x - middle;
                m.sum += d;
                m.squares += d.cwiseProduct(d);
                m.count += 1;
            }
        }
        chunk[c] = m;
    });
    Moments all;
    for (const Moments& m : chunk) {
        all.sum += m.sum;
        all.squares += m.squares;
        all.count += m.count;
    }
    return all;
}

}  // namespace

Bulk bulk_of(std::span<const Eigen::Vector3f> points) {
    constexpr int kRounds = 12;
    constexpr double kClip = 4;  // standard deviations
    Bulk bulk;
    Box box;
    for (int round = 0; round < kRounds; ++round) {
        const Moments m = moments_of(points, box, bulk.middle);
        const Eigen::Vector3d mean = m.sum / m.count,
                              deviation = (m.squares / m.count - mean.cwiseProduct(mean)).cwiseMax(0).cwiseSqrt();
        bulk.middle += mean;
        const double before = bulk.extent;
        bulk.extent = std::sqrt(12.0) * deviation.maxCoeff();  // of points spread evenly
        box.low = bulk.middle - Eigen::Vector3d::Constant(kClip * deviation.maxCoeff());
        box.high = bulk.middle + Eigen::Vector3d::Constant(kClip * deviation.maxCoeff());
        if (round > 0 && std::abs(before - bulk.extent) <= 1e-3 * bulk.extent) {
            break;
        }
    }
    return bulk;
}

std::vector<std::uint8_t> without_strays(std::span<const Eigen::Vector3f> points) {
    constexpr double kFar = 100;
    const Bulk bulk = bulk_of(points);
    std::vector<std::uint8_t> keep(points.size());
    parallel_for(points.size(), 1 << 16, [&](std::size_t i) {
        keep[i] = (points[i].cast<double>() - bulk.middle).cwiseAbs().maxCoeff() <= kFar * bulk.extent;
    });
    return std::find(keep.begin(), keep.end(), 0) == keep.end() ? std::vector<std::uint8_t>{} : keep;
}

}  // namespace seampath
