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

/// What the size alone says; a factor of 0 where it says nothing.
UnitChoice unit_by_size(ScanFormat format, double extent) {
    constexpr double kMmFrom = 20;
    constexpr double kMetresBelow = 2;
    if (extent >= kMmFrom) {
        return {1, "is 20 or more: millimetres"};
    }
    if (extent < kMetresBelow) {
        return {1000, "is below 2: metres"};
    }
    if (format == ScanFormat::pcd) {
        return {1000, "is between 2 and 20 in a PCD file, whose convention is metres: metres"};
    }
    return {0, ""};
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
    const UnitChoice by_size = unit_by_size(format, extent);
    const std::string size = "largest extent " + four_digits(extent);
    if (option != Unit::automatic) {
        constexpr std::array<double, 4> kMmPerUnit{0, 1, 1000, 25.4};
        const auto i = static_cast<std::size_t>(option);
        UnitChoice named{kMmPerUnit[i], "read.unit is " + std::string(kUnitNames[i])};
        if (by_size.mm_per_unit > 0 && by_size.mm_per_unit != named.mm_per_unit && option != Unit::inch) {
            named.reason += ", though " + size + " " + by_size.reason;
        }
        return named;
    }
    if (by_size.mm_per_unit == 0) {
        fail(source,
             size +
                 " does not tell its unit; 20 or more is taken as mm and below 2 as m; set read.unit to mm, m or inch");
    }
    return {by_size.mm_per_unit, size + " " + by_size.reason};
}

}  // namespace seampath
