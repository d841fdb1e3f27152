#pragma once

#include <span>
#include <vector>

#include "stages/plan/plan.hpp"
#include "stages/types.hpp"

/// Private to the plan stage: in which order seams are welded.
namespace seampath::planning {

/// A seam, and the options for it: direction and start are its own.
struct Visit {
    int seam = 0;
    PlanOptions options;
};

/// As found, or with plan.order = shortest the order of the least sum of straight ways from each retract to the next
/// approach; where plan.order_turns_seams allows it, open seams from either end, and where plan.order_moves_starts
/// does, closed ones from any of 12 places. Exact for few seams (dynamic programming over the sets of those that are
/// done; Held & Karp, J. SIAM 10, 1962), otherwise the best that moving single seams and reversing runs of them leads
/// to from the nearest neighbours of each (2-opt and Or-opt), with directions and starts the best for each order.
std::vector<Visit> visits(std::span<const SeamModel> models, const PlanOptions& options);

}  // namespace seampath::planning
