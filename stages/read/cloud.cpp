#include "stages/read/cloud.hpp"

#include <algorithm>

namespace seampath {

Eigen::Vector3d choose_origin(const std::vector<Eigen::Vector3d>& samples) {
    constexpr double kSizesFromZero = 16;
    Eigen::Vector3d median(0, 0, 0);
    double size = 0;
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<double> values;
        for (const auto& p : samples) {
            if (std::abs(p[axis]) <= kCoordinateLimit) {
                values.push_back(p[axis]);
            }
        }
        if (values.empty()) {
            continue;
        }
        std::sort(values.begin(), values.end());
        const std::size_t tenth = values.size() / 10;
        median[axis] = values[values.size() / 2];
        size = std::max(size, values[values.size() - 1 - tenth] - values[tenth]);
    }
    size = std::max(size, 1e-12 * median.cwiseAbs().maxCoeff());
    const double step = size > 0 ? kSizesFromZero * std::exp2(std::ceil(std::log2(size))) : 1;
    // Adding 0 turns -0 into 0.
    return ((median / step).array().round() * step + 0.0).matrix();
}

void fill_cloud(Cloud& cloud, const std::vector<std::size_t>& first, CloudParts parts,
                const std::function<void(std::size_t block, Slots& slots)>& decode) {
    const std::size_t blocks = first.size() - 1;
    const std::size_t count = first.back();
    cloud.points.resize(count);
    cloud.normals.resize(parts.normals ? count : 0);
    cloud.record.resize(parts.record_numbers ? count : 0);
    std::vector<std::size_t> kept(blocks);
    for_each_block(blocks, [&](std::size_t block) {
        Slots slots(cloud, first[block]);
        decode(block, slots);
        kept[block] = slots.kept();
    });
    std::size_t end = 0;
    for (std::size_t block = 0; block < blocks; ++block) {
        const auto close_gap = [&](auto& values) {
            if (!values.empty() && end != first[block]) {
                const auto begin = values.begin() + static_cast<std::ptrdiff_t>(first[block]);
                std::move(begin, begin + static_cast<std::ptrdiff_t>(kept[block]),
                          values.begin() + static_cast<std::ptrdiff_t>(end));
            }
        };
        close_gap(cloud.points);
        close_gap(cloud.normals);
        close_gap(cloud.record);
        end += kept[block];
    }
    cloud.points.resize(end);
    cloud.normals.resize(parts.normals ? end : 0);
    cloud.record.resize(parts.record_numbers ? end : 0);
}

}  // namespace seampath
