#include "stages/geometry/grid.hpp"

#include <array>
#include <bit>
#include <limits>
#include <utility>

#include "stages/error.hpp"
#include "stages/geometry/parallel.hpp"

namespace seampath {
namespace {

// More cells per axis than this can't be told apart by 32-bit floats anyway; it keeps keys within 63 bits.
constexpr double kMaxCellsPerAxis = 1 << 20;
constexpr std::size_t kChunks = 16;  // of the points, each with a count of its own for each bucket
constexpr std::size_t kMostBuckets = 1 << 16;
constexpr std::size_t kBucketPoints = 64;
constexpr std::size_t kGroups = 256;  // of buckets, sorted by one thread each

bool taken(std::span<const std::uint8_t> keep, std::size_t i) {
    return keep.empty() || keep[i] != 0;
}

struct Entry {
    std::uint64_t key;
    std::uint32_t index;
};

// Least-significant-digit radix sort by the low bits of the key: stable and linear.
void sort_by_key(std::vector<Entry>& entries, int bits) {
    constexpr int kDigit = 8;
    thread_local std::vector<Entry> other;
    other.resize(entries.size());
    for (int shift = 0; shift < bits; shift += kDigit) {
        const auto digit = [shift](const Entry& e) { return (e.key >> shift) & ((1u << kDigit) - 1); };
        std::array<std::size_t, (1u << kDigit) + 1> begin{};
        for (const Entry& e : entries) {
            ++begin[digit(e) + 1];
        }
        for (std::size_t k = 1; k < begin.size(); ++k) {
            begin[k] += begin[k - 1];
        }
        for (const Entry& e : entries) {
            other[begin[digit(e)]++] = e;
        }
        entries.swap(other);
    }
}

}  // namespace

// Returns how many points take part.
std::size_t PointGrid::set_bounds(std::span<const Eigen::Vector3f> points, std::span<const std::uint8_t> keep) {
    struct Bounds {
        Eigen::Vector3f low = Eigen::Vector3f::Constant(std::numeric_limits<float>::max()), high = -low;
        std::size_t count = 0;
    };
    std::array<Bounds, kChunks> chunk;
    parallel_chunks(points.size(), kChunks, [&](std::size_t c, std::size_t begin, std::size_t end) {
        Bounds b;
        for (std::size_t i = begin; i < end; ++i) {
            if (taken(keep, i)) {
                b.low = b.low.cwiseMin(points[i]);
                b.high = b.high.cwiseMax(points[i]);
                ++b.count;
            }
        }
        chunk[c] = b;
    });
    Bounds all;
    for (const Bounds& b : chunk) {
        all.low = all.low.cwiseMin(b.low);
        all.high = all.high.cwiseMax(b.high);
        all.count += b.count;
    }
    if (all.count == 0) {
        all.low = all.high = Eigen::Vector3f::Zero();
    }
    low_ = all.low.cast<double>();
    const Eigen::Vector3d extent = (all.high - all.low).cast<double>();
    cell_ = std::max(cell_, extent.maxCoeff() / kMaxCellsPerAxis);
    count_ = (extent / cell_).array().floor().cast<std::int64_t>() + 1;
    return all.count;
}

// Sorts the indices of the points by bucket, ascending within each: what source_ then holds. Returns where each bucket
// begins in it, and the end.
std::vector<std::uint32_t> PointGrid::sort_into_buckets(std::span<const Eigen::Vector3f> points,
                                                        std::span<const std::uint8_t> keep) {
    const std::uint64_t largest = key(count_.x() - 1, count_.y() - 1, count_.z() - 1);
    const std::size_t most = std::bit_floor(std::clamp<std::size_t>(source_.size() / kBucketPoints, 1, kMostBuckets));
    bucket_shift_ = std::max(0, static_cast<int>(std::bit_width(largest)) - static_cast<int>(std::bit_width(most)) + 1);
    const std::size_t buckets = (largest >> bucket_shift_) + 1, chunks = points.size() < kMostBuckets ? 1 : kChunks;
    std::vector<std::vector<std::uint32_t>> count(chunks);
    parallel_chunks(points.size(), chunks, [&](std::size_t c, std::size_t begin, std::size_t end) {
        count[c].assign(buckets, 0);
        for (std::size_t i = begin; i < end; ++i) {
            if (taken(keep, i)) {
                ++count[c][key_of(points[i]) >> bucket_shift_];
            }
        }
    });
    std::vector<std::uint32_t> begin_of(buckets + 1, 0);
    std::uint32_t sum = 0;
    for (std::size_t b = 0; b < buckets; ++b) {
        begin_of[b] = sum;
        for (auto& of_chunk : count) {
            sum += std::exchange(of_chunk[b], sum);
        }
    }
    begin_of[buckets] = sum;
    parallel_chunks(points.size(), chunks, [&](std::size_t c, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            if (taken(keep, i)) {
                source_[count[c][key_of(points[i]) >> bucket_shift_]++] = static_cast<std::uint32_t>(i);
            }
        }
    });
    return begin_of;
}

// Sorts what source_ holds from begin to end by cell, fetches its points, and appends its cells.
void PointGrid::sort_bucket(std::span<const Eigen::Vector3f> points, std::size_t begin, std::size_t end, Cells& cells) {
    thread_local std::vector<Entry> entries;
    entries.clear();
    for (std::size_t k = begin; k < end; ++k) {
        entries.push_back({key_of(points[source_[k]]), source_[k]});
    }
    sort_by_key(entries, bucket_shift_);
    for (std::size_t k = begin; k < end; ++k) {
        const auto& [key, index] = entries[k - begin];
        if (cells.empty() || cells.back().first != key) {
            cells.emplace_back(key, static_cast<std::uint32_t>(k));
        }
        source_[k] = index;
        sorted_[k] = points[index];
    }
}

PointGrid::PointGrid(std::span<const Eigen::Vector3f> points, double cell, std::span<const std::uint8_t> keep)
    : cell_(cell) {
    ensure(cell > 0 && std::isfinite(cell), "a grid needs cells of positive size");
    ensure(keep.empty() || keep.size() == points.size(), "one flag per point");
    ensure(points.size() < std::numeric_limits<std::uint32_t>::max(), "points are counted with 32 bits");
    source_.resize(set_bounds(points, keep));
    const std::vector<std::uint32_t> begin_of = sort_into_buckets(points, keep);
    sorted_.resize(source_.size());
    const std::size_t buckets = begin_of.size() - 1;
    std::vector<Cells> group(kGroups);
    parallel_chunks(buckets, kGroups, [&](std::size_t g, std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
            sort_bucket(points, begin_of[b], begin_of[b + 1], group[g]);
        }
    });
    for (const Cells& cells : group) {
        for (const auto& [key, start] : cells) {
            bucket_.resize((key >> bucket_shift_) + 1, static_cast<std::uint32_t>(key_.size()));
            key_.push_back(key);
            start_.push_back(start);
        }
    }
    bucket_.resize(buckets + 1, static_cast<std::uint32_t>(key_.size()));
    start_.push_back(static_cast<std::uint32_t>(sorted_.size()));
}

Eigen::Vector3d PointGrid::mean(std::size_t cell) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3f& p : points(cell)) {
        sum += p.cast<double>();
    }
    return sum / static_cast<double>(points(cell).size());
}

}  // namespace seampath
