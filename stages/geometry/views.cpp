#include "stages/geometry/views.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numeric>
#include <unordered_map>
#include <unordered_set>

#include "stages/geometry/robust.hpp"

namespace seampath {
namespace {

constexpr std::size_t kLeastPoints = 400;
constexpr std::size_t kMostChunks = 2000;  // each holds a few rows of a view, and a view some dozen of them
constexpr double kChunk = 1.0 / 6;         // of a row, in scans too small for that many; a row is as the root of all
constexpr std::size_t kSampled = 200;      // of a chunk's points
constexpr double kCells = 120;             // along the scan's extent
constexpr double kInCell = 7;              // points of a flat scan, where that makes cells larger
constexpr std::size_t kBehind = 30;        // chunks; rows of the latest ones share their cells
constexpr double kReturned = 0.4;          // share of kSpan chunks that tells of the next view
constexpr std::size_t kSpan = 3;           // chunks whose mean tells where a view looks

double cells_along(std::size_t points) {
    return std::min(kCells, std::sqrt(static_cast<double>(points) / kInCell));
}

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
        size_ = std::max(extent / cells_along(points.size()), 1e-9);
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

// Whether points that follow each other lie beside each other: a chunk comes more often to places of the few before it
// than to those of as many chunks from all over the scan. A scan that was shuffled, or thinned through a grid, tells
// nothing of views.
bool in_order(const std::vector<Chunk>& chunks, double cells) {
    constexpr std::size_t kTried = 200, kFew = 12;
    constexpr double kPlaces = 27;                 // along the scan's extent: rows are near then
    constexpr double kMoreOften = 1.3, kSure = 4;  // standard deviations
    const std::uint64_t within = std::bit_floor(static_cast<std::uint64_t>(std::max(2.0, cells / kPlaces))) - 1;
    const std::uint64_t place = ~(within | within << 12 | within << 24);
    double before = 0, elsewhere = 0;
    for (std::size_t at = kFew; at < chunks.size(); at += 1 + chunks.size() / kTried) {
        const auto met = [&](auto&& which) {
            std::unordered_set<std::uint64_t> places;
            for (std::size_t k = 0; k < kFew; ++k) {
                for (const std::uint64_t cell : chunks[which(k)].cells) {
                    places.insert(cell & place);
                }
            }
            return static_cast<double>(
                std::count_if(chunks[at].cells.begin(), chunks[at].cells.end(),
                              [&](std::uint64_t cell) { return places.contains(cell & place); }));
        };
        before += met([&](std::size_t k) { return at - 1 - k; });
        elsewhere +=
            met([&](std::size_t k) { return (at + (2 * k + 1) * chunks.size() / (2 * kFew)) % chunks.size(); });
    }
    return before > kMoreOften * elsewhere && before > elsewhere + kSure * std::sqrt(before + elsewhere);
}

// The chunks, ascending, with which another view begins at the latest (forwards) or at the earliest (backwards).
std::vector<std::size_t> returns_of(const std::vector<Chunk>& chunks, bool backwards) {
    std::vector<std::size_t> starts;
    std::unordered_map<std::uint64_t, std::size_t> seen;  // step at which the view first came to a cell
    std::vector<double> came_back;                        // share of each chunk since the view began
    for (std::size_t step = 0; step < chunks.size(); ++step) {
        const std::size_t at = backwards ? chunks.size() - 1 - step : step;
        const auto returned = std::count_if(chunks[at].cells.begin(), chunks[at].cells.end(), [&](std::uint64_t cell) {
            const auto found = seen.find(cell);
            return found != seen.end() && found->second + kBehind < step;
        });
        came_back.push_back(static_cast<double>(returned) / static_cast<double>(chunks[at].cells.size()));
        // One chunk alone may be strays.
        const std::size_t span = std::min(kSpan, came_back.size());
        if (std::accumulate(came_back.end() - static_cast<std::ptrdiff_t>(span), came_back.end(), 0.0) >
            kReturned * static_cast<double>(kSpan)) {
            starts.push_back(backwards ? at + 1 : at);
            seen.clear();
            came_back.clear();
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
    if (points.size() < kLeastPoints) {
        return starts;
    }
    const auto part_of_row = static_cast<std::size_t>(kChunk * std::sqrt(static_cast<double>(points.size())));
    const std::size_t size = std::max(part_of_row, points.size() / kMostChunks);
    const std::vector<Chunk> chunks = chunks_of(points, size);
    if (!in_order(chunks, cells_along(points.size()))) {
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
