#include "stages/extract/pool.hpp"

#include <algorithm>
#include <cmath>

#include "stages/geometry/robust.hpp"

namespace seampath::detail {
namespace {

constexpr std::size_t kMostPooled = 60000;

}  // namespace

Pool pool_of(const Tracker& tracker, const std::vector<TrackPoint>& way, int k) {
    constexpr std::uint32_t kBands = 3;
    Pool pool;
    std::size_t count = 0;
    for (const TrackPoint& place : way) {
        count += place.slab[k].size();
    }
    const std::size_t stride = 1 + count / kMostPooled;
    const ScanScale scale = tracker.scale_at(way[way.size() / 2].section);
    pool.correlation = 1 + (scale.correlation - 1) / static_cast<double>(stride);
    const double along = tracker.window_of(scale).along;
    pool.reach = std::clamp<std::size_t>(static_cast<std::size_t>(std::lround(along / tracker.step)), 1,
                                         std::max<std::size_t>(1, way.size() / 16));
    std::vector<double> scales;
    count = 0;
    for (std::size_t i = 0; i < way.size(); ++i) {
        for (const FlankSample& sample : way[i].slab[k]) {
            if (count++ % stride == 0) {
                pool.points.push_back(sample.p.cast<double>());
                pool.place.push_back(static_cast<std::uint32_t>(i));
                pool.u.push_back(sample.u);
                pool.view.push_back(sample.view);
            }
        }
        if (!way[i].modelled) {
            pool.places.push_back(way[i].section.p);
            pool.normals.push_back(k == 0 ? way[i].section.n1 : way[i].section.n2);
            scales.push_back(way[i].flank_scale[k]);
        }
    }
    pool.scale = quantile(scales, 0.5);
    std::vector<double> sorted = pool.u;
    const double third = quantile(sorted, 1.0 / 3), two_thirds = quantile(sorted, 2.0 / 3);
    for (std::size_t i = 0; i < pool.points.size(); ++i) {
        const std::uint32_t band = (pool.u[i] > third) + (pool.u[i] > two_thirds);
        pool.station_block.push_back(static_cast<std::uint32_t>(pool.place[i] / (2 * pool.reach)));
        pool.block.push_back(pool.station_block.back() * kBands + band);
    }
    return pool;
}

}  // namespace seampath::detail
