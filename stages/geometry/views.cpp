#include "stages/geometry/views.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include "stages/geometry/robust.hpp"

namespace seampath {
namespace {

constexpr std::size_t kMostChunks = 2000;  // each holds a few rows of a view, and a view some dozen of them
constexpr std::size_t kLeastInChunk = 50;  // points
constexpr std::size_t kSampled = 200;      // of a chunk's points
constexpr double kCells = 120;             // along the scan's extent
constexpr std::size_t kBehind = 30;        // chunks; rows of the latest ones share their cells
constexpr double kReturned = 0.5;          // share of a chunk's points that tells of the next view

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

}  // namespace

std::vector<std::size_t> view_starts(std::span<const Eigen::Vector3f> points) {
    std::vector<std::size_t> starts{0};
    if (points.size() < 4 * kBehind * kLeastInChunk) {
        return starts;
    }
    const std::size_t size = std::max(kLeastInChunk, points.size() / kMostChunks), stride = 1 + size / kSampled;
    const Cells cells(points);
    std::unordered_map<std::uint64_t, std::size_t> seen;  // chunk in which the view first came to a cell
    for (std::size_t chunk = 0; chunk * size < points.size(); ++chunk) {
        std::size_t sampled = 0, returned = 0;
        const std::size_t begin = chunk * size, end = std::min(points.size(), begin + size);
        for (std::size_t i = begin; i < end; i += stride, ++sampled) {
            const auto found = seen.find(cells.key(points[i]));
            returned += found != seen.end() && found->second + kBehind < chunk;
        }
        if (static_cast<double>(returned) > kReturned * static_cast<double>(sampled)) {
            starts.push_back(begin);
            seen.clear();
        }
        for (std::size_t i = begin; i < end; i += stride) {
            seen.try_emplace(cells.key(points[i]), chunk);
        }
    }
    return starts;
}

}  // namespace seampath
