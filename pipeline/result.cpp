#include "pipeline/result.hpp"

#include <algorithm>

namespace seampath {

bool PartResult::pass() const {
    if ((plan.arm && !plan.arm->pass) || !plan.refused.empty()) {
        return false;
    }
    if (nominal) {
        return !models.empty();
    }
    return !deviations.empty() &&
           std::all_of(deviations.begin(), deviations.end(), [](const Deviation& deviation) { return deviation.pass; });
}

std::vector<Eigen::Vector3d> node_positions(const Seam& seam, const Nodes& nodes) {
    if (nodes.line) {
        return nodes.line->p;
    }
    std::vector<Eigen::Vector3d> positions;
    for (const std::size_t node : nodes.index) {
        positions.push_back(seam.points.at(node).p);
    }
    return positions;
}

}  // namespace seampath
