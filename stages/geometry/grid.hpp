#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
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
                auto it = std::lower_bound(key_.begin(), key_.end(), key(a[0], y, z));
                for (; it != key_.end() && *it <= last; ++it) {
                    f(static_cast<std::size_t>(it - key_.begin()));
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

    double cell_;
    Eigen::Vector3d low_;
    Eigen::Matrix<std::int64_t, 3, 1> count_;
    std::vector<Eigen::Vector3f> sorted_;
    std::vector<std::uint32_t> source_;
    std::vector<std::uint64_t> key_;  ///< of each occupied cell, ascending
    std::vector<std::size_t> start_;  ///< first point of each cell, and the end
};

}  // namespace seampath
