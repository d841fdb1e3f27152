#include "stages/geometry/flank_pool.hpp"

#include <algorithm>

#include "stages/geometry/robust.hpp"

namespace seampath {

FlankPool pool_of(std::span<const FlankPlace> places, std::size_t reach, double correlation) {
    constexpr std::size_t kMostPoints = 60000, kLeastWindows = 16;
    constexpr std::uint32_t kBands = 3;
    FlankPool pool;
    std::size_t count = 0;
    for (const FlankPlace& place : places) {
        count += place.slab.size();
    }
    const std::size_t stride = 1 + count / kMostPoints;
    pool.correlation = 1 + (correlation - 1) / static_cast<double>(stride);
    pool.reach = std::clamp<std::size_t>(reach, 1, std::max<std::size_t>(1, places.size() / kLeastWindows));
    const bool none_measured = std::ranges::none_of(places, &FlankPlace::measured);
    std::vector<double> scales;
    count = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        for (const SlabPoint& sample : places[i].slab) {
            if (count++ % stride == 0) {
                pool.points.push_back(sample.p.cast<double>());
                pool.place.push_back(static_cast<std::uint32_t>(i));
                pool.u.push_back(sample.u);
                pool.view.push_back(sample.view);
            }
        }
        if (places[i].measured || none_measured) {
            pool.places.push_back(places[i].p);
            pool.normals.push_back(places[i].normal);
            scales.push_back(places[i].scale);
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

}  // namespace seampath
