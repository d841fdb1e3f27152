#include "stages/read/unit.hpp"

#include <algorithm>
#include <array>
#include <charconv>

namespace seampath {
namespace {

std::string four_digits(double value) {
    std::array<char, 32> text;
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 4).ptr;
    return {text.data(), end};
}

}  // namespace

double largest_extent(const std::vector<Eigen::Vector3f>& points) {
    constexpr std::size_t kSamples = 1 << 17;
    constexpr std::size_t kPerStray = 1000;
    const std::size_t step = (points.size() + kSamples - 1) / kSamples;
    double extent = 0;
    for (int axis = 0; axis < 3 && !points.empty(); ++axis) {
        std::vector<float> values;
        for (std::size_t i = 0; i < points.size(); i += step) {
            values.push_back(points[i][axis]);
        }
        const auto stray = static_cast<std::ptrdiff_t>(values.size() / kPerStray);
        const auto nth = [&](std::ptrdiff_t n) {
            std::nth_element(values.begin(), values.begin() + n, values.end());
            return static_cast<double>(values[static_cast<std::size_t>(n)]);
        };
        const double high = nth(static_cast<std::ptrdiff_t>(values.size()) - 1 - stray);
        extent = std::max(extent, high - nth(stray));
    }
    return extent;
}

UnitChoice choose_unit(const Source& source, Unit option, ScanFormat format, double extent) {
    constexpr double kMmFrom = 20;
    constexpr double kMetresBelow = 2;
    const std::string size = "largest extent " + four_digits(extent) + " ";
    switch (option) {
        case Unit::mm:
            return {1, "read.unit is mm"};
        case Unit::m:
            return {1000, "read.unit is m"};
        case Unit::inch:
            return {25.4, "read.unit is inch"};
        case Unit::automatic:
            break;
    }
    if (extent >= kMmFrom) {
        return {1, size + "is 20 or more: millimetres"};
    }
    if (extent < kMetresBelow) {
        return {1000, size + "is below 2: metres"};
    }
    if (format == ScanFormat::pcd) {
        return {1000, size + "is between 2 and 20 in a PCD file, whose convention is metres: metres"};
    }
    fail(source,
         size + "does not tell its unit; 20 or more is taken as mm and below 2 as m; set read.unit to mm, m or inch");
}

}  // namespace seampath
