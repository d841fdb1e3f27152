#pragma once

#include <optional>

#include "stages/plan/clearance.hpp"
#include "stages/plan/torch.hpp"

/// Private to the plan stage: how a torch that would touch the scan is held aside.
namespace seampath::planning {

/// Leans the torch of a path aside, and turns one with a bent neck about its wire, so that it touches the scan nowhere:
/// of the ways over a grid of leans, to a degree at places 2.5 mm apart (with a bent neck 2 deg, turns of 20 deg up to
/// 100, 5 mm), the one of the least sum of squared angles in which the lean changes by no more than
/// plan.free_angle_rate_deg_mm (Viterbi, IEEE Trans. Inf. Theory 13, 1967). A torch that
/// touches nothing stays as it is. Where there is no such way, returns where even the best lean leaves the scan
/// deepest in the torch, and how deep.
std::optional<SeamRefusal> hold_clear(TorchPath& path, const Clearance& clearance, const PlanOptions& options);

}  // namespace seampath::planning
