#include "stages/geometry/views.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <unordered_map>
#include <unordered_set>

#include "stages/geometry/robust.hpp"

namespace seampath {
namespace {

constexpr std::size_t kMostChunks = 2000;  // each holds a few rows of a view, and a view some dozen of them
constexpr std::size_t kLeastInChunk = 50;  // points
constexpr std::size_t kSampled = 200;      // of a chunk's points
constexpr double kCells = 120;             // along the scan's extent
constexpr std::size_t kBehind = 30;        // chunks; rows of the latest ones share their cells
constexpr double kReturned = 0.5;          // share of a chunk's points that tells of the next view
constexpr std::size_t kSpan = 3;           // chunks whose mean tells where a view looks

// Integer coordinates of cells, packed.
class Cells {
public:
    explicit Cells(std::span<const Eigen::Vector3f> points) {
        std::vector<double> x[3];
        for (std::size_t i = 0; i < points.size(); i += 1 + points.size() / 5000) {
            for (int axis = 0; axis < 3; ++axis) {
                x[axis].push_back(points[i][axis]);
            }
        }
        double extent = 0;
        for (int axis = 0; axis < 3; ++axis) {
            low_[axis] = quantile(x[axis], 0.01);
            extent = std::max(extent, quantile(x[axis], 0.99) - low_[axis]);
        }
        size_ = std::max(extent / kCells, 1e-9);
    }
    std::uint64_t key(const Eigen::Vector3f& p) const {
        std::uint64_t key = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const double x = std::clamp(std::floor((p[axis] - low_[axis]) / size_), -1000.0, 1000.0);
            key = key << 12 | static_cast<std::uint64_t>(x + 1000);
        }
        return key;
    }

private:
    double low_[3];
    double size_;
};

/// Points that follow each other in the scan, a chunk at a time: the cells that they lie in, and their middle.
struct Chunk {
    std::vector<std::uint64_t> cells;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
};

std::vector<Chunk> chunks_of(std::span<const Eigen::Vector3f> points, std::size_t size) {
    const Cells cells(points);
    const std::size_t stride = 1 + size / kSampled;
    std::vector<Chunk> chunks;
    for (std::size_t begin = 0; begin < points.size(); begin += size) {
        Chunk& chunk = chunks.emplace_back();
        for (std::size_t i = begin; i < std::min(points.size(), begin + size); i += stride) {
            chunk.cells.push_back(cells.key(points[i]));
            chunk.middle += points[i].cast<double>();
        }
        chunk.middle /= static_cast<double>(chunk.cells.size());
    }
    return chunks;
}

// Whether points that follow each other lie beside each other: a chunk comes to places of the few before it far more
// often than to any others. A scan that was shuffled, or thinned through a grid, tells nothing of views.
bool in_order(const std::vector<Chunk>& chunks) {
    constexpr std::size_t kTried = 30;
    constexpr double kMoreOften = 1.5;
    constexpr std::uint64_t kPlace = ~std::uint64_t{3 | 3 << 12 | 3 << 24};  // four cells each way: rows are near then
    const auto add_places = [](const Chunk& chunk, std::unordered_set<std::uint64_t>& places) {
        for (const std::uint64_t cell : chunk.cells) {
            places.insert(cell & kPlace);
        }
    };
    std::unordered_set<std::uint64_t> all;
    for (std::size_t i = 0; i < chunks.size(); i += 4) {
        add_places(chunks[i], all);
    }
    double met = 0, expected = 0;
    for (std::size_t at = kBehind; at < chunks.size(); at += 1 + chunks.size() / kTried) {
        std::unordered_set<std::uint64_t> before;
        for (std::size_t i = at - kBehind; i < at; ++i) {
            add_places(chunks[i], before);
        }
        for (const std::uint64_t cell : chunks[at].cells) {
            met += before.contains(cell & kPlace);
        }
        expected += static_cast<double>(before.size() * chunks[at].cells.size()) / static_cast<double>(all.size());
    }
    return met > kMoreOften * expected;
}

// The chunks, ascending, with which another view begins at the latest (forwards) or at the earliest (backwards).
std::vector<std::size_t> returns_of(const std::vector<Chunk>& chunks, bool backwards) {
    std::vector<std::size_t> starts;
    std::unordered_map<std::uint64_t, std::size_t> seen;  // step at which the view first came to a cell
    for (std::size_t step = 0; step < chunks.size(); ++step) {
        const std::size_t at = backwards ? chunks.size() - 1 - step : step;
        std::size_t returned = 0;
        for (const std::uint64_t cell : chunks[at].cells) {
            const auto found = seen.find(cell);
            returned += found != seen.end() && found->second + kBehind < step;
        }
        if (static_cast<double>(returned) > kReturned * static_cast<double>(chunks[at].cells.size())) {
            starts.push_back(backwards ? at + 1 : at);
            seen.clear();
        }
        for (const std::uint64_t cell : chunks[at].cells) {
            seen.try_emplace(cell, step);
        }
    }
    std::sort(starts.begin(), starts.end());
    return starts;
}

// How far the view's look jumps where a chunk begins.
double jump_at(const std::vector<Chunk>& chunks, std::size_t at) {
    Eigen::Vector3d before = Eigen::Vector3d::Zero(), after = before;
    for (std::size_t i = 0; i < kSpan; ++i) {
        before += chunks[at - 1 - i].middle;
        after += chunks[at + i].middle;
    }
    return (after - before).norm();
}

}  // namespace

// A view that begins with places which the one before it did not see is noticed late; read backwards, its end is
// noticed early. Between the two it begins where the look jumps from the last row to the first.
std::vector<std::size_t> view_starts(std::span<const Eigen::Vector3f> points) {
    std::vector<std::size_t> starts{0};
    if (points.size() < 4 * kBehind * kLeastInChunk) {
        return starts;
    }
    const std::size_t size = std::max(kLeastInChunk, points.size() / kMostChunks);
    const std::vector<Chunk> chunks = chunks_of(points, size);
    if (!in_order(chunks)) {
        return starts;
    }
    const std::vector<std::size_t> earliest = returns_of(chunks, true);
    std::size_t last = 0;
    for (const std::size_t latest : returns_of(chunks, false)) {
        const auto before = std::upper_bound(earliest.begin(), earliest.end(), latest);
        std::size_t start = std::max(before == earliest.begin() ? 0 : *std::prev(before), last + kSpan);
        double most = 0;
        for (std::size_t at = start; at <= latest && at + kSpan <= chunks.size(); ++at) {
            if (const double jump = jump_at(chunks, at); jump > most) {
                most = jump;
                start = at;
            }
        }
        starts.push_back(start * size);
        last = start;
    }
    return starts;
}

}  // namespace seampath
