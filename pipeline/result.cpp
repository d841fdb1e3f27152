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

}  // namespace seampath
