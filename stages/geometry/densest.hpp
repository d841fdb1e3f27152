#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace seampath {

/// The interval of a given width that holds most of some values: its lowest value, the middle one by rank, and how many
/// there are.
struct Densest {
    double low = 0, middle = 0;
    std::size_t count = 0;
};

inline Densest densest(std::vector<double> values, double width) {
    std::sort(values.begin(), values.end());
    Densest best;
    std::size_t first = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        while (values[i] - values[first] > width) {
            ++first;
        }
        if (i - first + 1 > best.count) {
            best = {values[first], values[first + (i - first) / 2], i - first + 1};
        }
    }
    return best;
}

}  // namespace seampath
