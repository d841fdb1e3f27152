#include "stages/extract/registration.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <Eigen/Cholesky>

namespace seampath::detail {
namespace {

/// Sum and number of what one view's points are off a flank's surface.
struct Off {
    double sum = 0, count = 0;
};
using OffByView = std::map<std::uint32_t, Off>;

OffByView off_by_view(const std::vector<TrackPoint>& way, std::size_t begin, std::size_t end, int k) {
    OffByView views;
    for (std::size_t i = begin; i < end; ++i) {
        for (const SlabPoint& sample : way[i].slab[k]) {
            Off& off = views[sample.view];
            off.sum += sample.off;
            off.count += 1;
        }
    }
    return views;
}

}  // namespace

void add_differences(ViewDifferences& sum, const std::vector<TrackPoint>& way) {
    constexpr std::size_t kStretch = 6;  // places: long against what neighbours share, short against a seam's bends
    constexpr double kLeast = 30;        // points of a view
    for (int k = 0; k < 2; ++k) {
        OffByView before;
        for (std::size_t begin = 0; begin + kStretch <= way.size(); begin += kStretch) {
            const OffByView here = off_by_view(way, begin, begin + kStretch, k);
            // Of the two views a and b, on this stretch and the one before it.
            const auto apart = [](const OffByView& views, std::uint32_t a, std::uint32_t b) -> std::optional<double> {
                const auto x = views.find(a), y = views.find(b);
                const bool seen =
                    x != views.end() && y != views.end() && std::min(x->second.count, y->second.count) >= kLeast;
                return seen ? std::optional(x->second.sum / x->second.count - y->second.sum / y->second.count)
                            : std::nullopt;
            };
            for (auto a = here.begin(); a != here.end(); ++a) {
                for (auto b = std::next(a); b != here.end(); ++b) {
                    const auto now = apart(here, a->first, b->first), then = apart(before, a->first, b->first);
                    if (now && then) {
                        sum.products += *now * *then;
                        sum.pairs += 1;
                    }
                }
            }
            before = here;
        }
    }
}

double registration_of(const ViewDifferences& sum) {
    return sum.pairs > 0 ? std::sqrt(std::max(0.0, sum.products) / sum.pairs / 2) : 0;
}

std::vector<double> shift_of_windows(const Tracker& tracker, const std::vector<TrackPoint>& way, int k) {
    std::vector<double> variance;
    for (std::size_t i = 0; i < way.size(); ++i) {
        const auto reach = static_cast<std::size_t>(std::lround(way[i].along / tracker.step));
        const OffByView views = off_by_view(way, i > reach ? i - reach : 0, std::min(way.size(), i + reach + 1), k);
        double squares = 0, all = 0;
        for (const auto& [view, off] : views) {
            squares += off.count * off.count;
            all += off.count;
        }
        variance.push_back(all > 0 ? squares / (all * all) : 1);
    }
    return variance;
}

// A shift b of a view changes the distances of its points by -n.b: the normal equations with that on their right side.
ShiftOfSurface::ShiftOfSurface(const SurfaceFit& surface, const FlankPool& pool) : surface_(surface) {
    const int n = surface.parameters();
    SurfaceFit::Matrix normal = SurfaceFit::Matrix::Zero(n, n);
    std::map<std::uint32_t, Influence> sums;
    for (std::size_t i = 0; i < pool.points.size(); ++i) {
        const SurfaceFit::Vector row = surface.weight(pool.points[i]) * surface.row(pool.points[i]);
        normal += row * surface.row(pool.points[i]).transpose();
        const auto [sum, fresh] = sums.try_emplace(pool.view[i], Influence::Zero(n, 3));
        sum->second += row * surface.normal(pool.points[i]).transpose();
    }
    const Eigen::LDLT<SurfaceFit::Matrix> ldlt(normal);
    for (const auto& [view, sum] : sums) {
        influence_.push_back(ldlt.solve(sum));
    }
}

double ShiftOfSurface::at(const Eigen::Vector3d& p) const {
    double variance = 0;
    for (const Influence& influence : influence_) {
        variance += (surface_.row(p).transpose() * influence).squaredNorm();
    }
    return variance;
}

}  // namespace seampath::detail
