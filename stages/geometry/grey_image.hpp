#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace seampath {

/// A picture of one channel, row by row from the top left. Pixel (column, row) has its middle at x = column, y = row.
struct GreyImage {
    int width = 0;
    int height = 0;
    double white = 255;        ///< largest value that a pixel can have: 255 or 65535
    std::vector<float> value;  ///< width * height

    float at(int column, int row) const {
        return value[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                     static_cast<std::size_t>(column)];
    }
    /// Beyond the border the picture goes on as it ends.
    float clamped(int column, int row) const {
        return at(std::clamp(column, 0, width - 1), std::clamp(row, 0, height - 1));
    }
};

}  // namespace seampath
