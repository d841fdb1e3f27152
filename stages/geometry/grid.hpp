#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

namespace seampath {

/// Points sorted into cubic cells. One structure serves coarse work (a cell's mean stands for its points) and exact
/// work (all raw points of a box). Cells are in ascending order of their integer coordinates, z before y before x,
/// whatever the order in which the points came.
class PointGrid {
public:
    /// `keep`, when not empty, says which points take part. Needs finite points; cell > 0, mm.
    PointGrid(std::span<const Eigen::Vector3f> points, double cell, std::span<const std::uint8_t> keep = {});

    double cell() const { return cell_; }
    std::size_t cells() const { return key_.size(); }
    std::size_t size() const { return sorted_.size(); }
    std::span<const Eigen::Vector3f> points(std::size_t cell) const {
        return {sorted_.data() + start_[cell], start_[cell + 1] - start_[cell]};
    }
    std::span<const Eigen::Vector3f> all() const { return sorted_; }
    /// Index, in the constructor's `points`, of the k-th point of all().
    std::uint32_t source(std::size_t k) const { return source_[k]; }
    std::size_t first_point(std::size_t cell) const { return start_[cell]; }
    Eigen::Vector3d mean(std::size_t cell) const;

    /// Calls f(cell) for every occupied cell that touches the axis-aligned box.
    template <class F>
    void for_cells_in_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high, F&& f) const {
        std::int64_t a[3], b[3];
        for (int axis = 0; axis < 3; ++axis) {
            a[axis] = std::max<std::int64_t>(0, coordinate(low[axis], axis));
            b[axis] = std::min<std::int64_t>(count_[axis] - 1, coordinate(high[axis], axis));
        }
        for (std::int64_t z = a[2]; z <= b[2]; ++z) {
            for (std::int64_t y = a[1]; y <= b[1] && a[0] <= b[0]; ++y) {
                const std::uint64_t last = key(b[0], y, z);
                for (std::size_t i = first_from(key(a[0], y, z)); i < key_.size() && key_[i] <= last; ++i) {
                    f(i);
                }
            }
        }
    }

    /// Calls f(point, squared distance) for every point within `radius` of p.
    template <class F>
    void for_points_in_ball(const Eigen::Vector3d& p, double radius, F&& f) const {
        const Eigen::Vector3d reach = Eigen::Vector3d::Constant(radius);
        for_cells_in_box(p - reach, p + reach, [&](std::size_t cell) {
            for (const Eigen::Vector3f& q : points(cell)) {
                const double d2 = (q.cast<double>() - p).squaredNorm();
                if (d2 <= radius * radius) {
                    f(q, d2);
                }
            }
        });
    }

private:
    std::int64_t coordinate(double x, int axis) const {
        return static_cast<std::int64_t>(std::floor((x - low_[axis]) / cell_));
    }
    std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z) const {
        return static_cast<std::uint64_t>((z * count_[1] + y) * count_[0] + x);
    }
    std::uint64_t key_of(const Eigen::Vector3f& p) const {
        const auto at = [&](int axis) {
            return std::min(static_cast<std::int64_t>((p[axis] - low_[axis]) / cell_), count_[axis] - 1);
        };
        return key(at(0), at(1), at(2));
    }
    /// The first cell whose key is not below the given one.
    std::size_t first_from(std::uint64_t key) const {
        const std::uint64_t b = key >> bucket_shift_;
        const auto begin = key_.begin() + bucket_[b], end = key_.begin() + bucket_[b + 1];
        return static_cast<std::size_t>(std::lower_bound(begin, end, key) - key_.begin());
    }

    using Cells = std::vector<std::pair<std::uint64_t, std::uint32_t>>;  ///< ascending: key, and the first point
    std::size_t set_bounds(std::span<const Eigen::Vector3f> points, std::span<const std::uint8_t> keep);
    std::vector<std::uint32_t> sort_into_buckets(std::span<const Eigen::Vector3f> points,
                                                 std::span<const std::uint8_t> keep);
    void sort_bucket(std::span<const Eigen::Vector3f> points, std::size_t begin, std::size_t end, Cells& cells);

    double cell_;
    Eigen::Vector3d low_;
    Eigen::Matrix<std::int64_t, 3, 1> count_;
    std::vector<Eigen::Vector3f> sorted_;
    std::vector<std::uint32_t> source_;
    std::vector<std::uint64_t> key_;     ///< of each occupied cell, ascending
    std::vector<std::uint32_t> start_;   ///< first point of each cell, and the end
    int bucket_shift_ = 0;               ///< keys that are alike but for so many bits share a bucket
    std::vector<std::uint32_t> bucket_;  ///< first cell of each bucket, and the end
};

}  // namespace seampath
