#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace seampath::detail {

/// Places about `step` mm apart, all alike, along the polyline through the places of a way; open ways keep both ends.
/// `position` gives a place's point, mm; `between(a, b, x)` the place x of the way from a to b. A way of a single place
/// stays what it is.
template <class Place, class Position, class Between>
std::vector<Place> equal_steps(std::vector<Place> way, bool closed, double step, Position&& position,
                               Between&& between) {
    if (way.size() < 2) {
        return way;
    }
    if (closed) {
        way.push_back(way.front());
    }
    std::vector<double> station(way.size(), 0);
    for (std::size_t i = 1; i < way.size(); ++i) {
        station[i] = station[i - 1] + (position(way[i]) - position(way[i - 1])).norm();
    }
    const auto count = std::max<std::size_t>(3, static_cast<std::size_t>(std::lround(station.back() / step)));
    std::vector<Place> places;
    for (std::size_t k = 0, i = 1; k < count + (closed ? 0 : 1); ++k) {
        const double s = station.back() * static_cast<double>(k) / static_cast<double>(count);
        while (i + 1 < way.size() && station[i] < s) {
            ++i;
        }
        const double x = std::clamp((s - station[i - 1]) / std::max(1e-12, station[i] - station[i - 1]), 0.0, 1.0);
        places.push_back(between(way[i - 1], way[i], x));
    }
    return places;
}

}  // namespace seampath::detail
