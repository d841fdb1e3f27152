#include "stages/geometry/grid.hpp"

#include <array>

#include "stages/error.hpp"

namespace seampath {
namespace {

struct Entry {
    std::uint64_t key;
    std::uint32_t index;
};

// Least-significant-digit radix sort by key: stable, linear, and the number of passes follows from the largest key.
void sort_by_key(std::vector<Entry>& entries, std::uint64_t largest) {
    constexpr int kBits = 11;
    std::vector<Entry> other(entries.size());
    for (int shift = 0; shift < 64 && (largest >> shift) != 0; shift += kBits) {
        std::array<std::size_t, (1u << kBits) + 1> begin{};
        for (const Entry& e : entries) {
            ++begin[((e.key >> shift) & ((1u << kBits) - 1)) + 1];
        }
        for (std::size_t k = 1; k < begin.size(); ++k) {
            begin[k] += begin[k - 1];
        }
        for (const Entry& e : entries) {
            other[begin[(e.key >> shift) & ((1u << kBits) - 1)]++] = e;
        }
        entries.swap(other);
    }
}

// More cells per axis than this can't be told apart by 32-bit floats anyway; it keeps keys within 63 bits.
constexpr double kMaxCellsPerAxis = 1 << 20;

}  // namespace

PointGrid::PointGrid(std::span<const Eigen::Vector3f> points, double cell, std::span<const std::uint8_t> keep)
    : cell_(cell) {
    ensure(cell > 0 && std::isfinite(cell), "a grid needs cells of positive size");
    ensure(keep.empty() || keep.size() == points.size(), "one flag per point");
    const auto taken = [&](std::size_t i) { return keep.empty() || keep[i] != 0; };
    Eigen::Vector3f low = Eigen::Vector3f::Constant(std::numeric_limits<float>::max()), high = -low;
    std::size_t count = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (taken(i)) {
            low = low.cwiseMin(points[i]);
            high = high.cwiseMax(points[i]);
            ++count;
        }
    }
    if (count == 0) {
        low = high = Eigen::Vector3f::Zero();
    }
    low_ = low.cast<double>();
    const Eigen::Vector3d extent = (high - low).cast<double>();
    cell_ = std::max(cell_, extent.maxCoeff() / kMaxCellsPerAxis);
    count_ = (extent / cell_).array().floor().cast<std::int64_t>() + 1;

    std::vector<Entry> entries;
    entries.reserve(count);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (taken(i)) {
            const Eigen::Vector3d at = ((points[i].cast<double>() - low_) / cell_).array().floor();
            const auto x = static_cast<std::int64_t>(at.x()), y = static_cast<std::int64_t>(at.y()),
                       z = static_cast<std::int64_t>(at.z());
            entries.push_back(
                {key(std::min(x, count_.x() - 1), std::min(y, count_.y() - 1), std::min(z, count_.z() - 1)),
                 static_cast<std::uint32_t>(i)});
        }
    }
    sort_by_key(entries, key(count_.x() - 1, count_.y() - 1, count_.z() - 1));
    sorted_.reserve(count);
    source_.reserve(count);
    for (const Entry& e : entries) {
        if (key_.empty() || key_.back() != e.key) {
            key_.push_back(e.key);
            start_.push_back(sorted_.size());
        }
        sorted_.push_back(points[e.index]);
        source_.push_back(e.index);
    }
    start_.push_back(sorted_.size());
}

Eigen::Vector3d PointGrid::mean(std::size_t cell) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3f& p : points(cell)) {
        sum += p.cast<double>();
    }
    return sum / static_cast<double>(points(cell).size());
}

}  // namespace seampath
