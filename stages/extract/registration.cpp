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

double registration_that_counts(double registration_mm, std::size_t views, double noise_mm) {
    if (views < 2) {
        return 0;
    }
    // Two flanks see each view in two directions.
    constexpr double kBefore = 2;
    const double told = 2 * (static_cast<double>(views) - 1), freedom = told + kBefore, usual = noise_mm / 2;
    return std::sqrt((told * registration_mm * registration_mm + kBefore * usual * usual) / freedom);
}

// A shift b of a view changes the distances of its points by -n.b: the normal equations with that on their right side.
// Such a step of the parameters moves the surface by row.step against its normal.
ShiftOfSurface::ShiftOfSurface(const SurfaceFit& surface, const FlankPool& pool, std::size_t views)
    : surface_(surface) {
    const int n = surface.parameters();
    SurfaceFit::Matrix normal = SurfaceFit::Matrix::Zero(n, n);
    std::vector<Influence> sums(views, Influence::Zero(n, 4));
    for (std::size_t i = 0; i < pool.points.size(); ++i) {
        const SurfaceFit::Vector row = surface.row(pool.points[i]);
        const Eigen::Vector3d at = surface.normal(pool.points[i]);
        const double w = surface.weight(pool.points[i]);
        normal += w * row * row.transpose();
        sums[pool.view[i] - 1] += w * row * Eigen::RowVector4d(at.x(), at.y(), at.z(), 1);
    }
    const Eigen::LDLT<SurfaceFit::Matrix> ldlt(normal);
    for (const Influence& sum : sums) {
        influence_.push_back(ldlt.solve(sum));
    }
}

ViewShares ShiftOfSurface::at(const Eigen::Vector3d& p) const {
    const auto views = static_cast<Eigen::Index>(influence_.size());
    ViewShares shares{Eigen::VectorXd(3 * views), Eigen::VectorXd(views)};
    const SurfaceFit::Vector row = surface_.row(p);
    for (Eigen::Index v = 0; v < views; ++v) {
        const Eigen::RowVector4d share = row.transpose() * influence_[static_cast<std::size_t>(v)];
        shares.by_axis.segment<3>(3 * v) = share.head<3>().transpose();
        shares.by_normal[v] = share[3];
    }
    return shares;
}

}  // namespace seampath::detail
