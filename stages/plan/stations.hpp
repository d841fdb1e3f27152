#pragma once

#include <vector>

#include "stages/plan/chord.hpp"
#include "stages/plan/speed.hpp"
#include "stages/plan/torch.hpp"

/// Private to the plan stage: where along a seam the waypoints lie.
namespace seampath::planning {

struct WeldPoses {
    std::vector<TorchPose> poses;   ///< first at station 0, last at the seam's length
    double max_chord_error_mm = 0;  ///< upper bound of the curve's distance from the chords
};

/// Where plan.period_s, plan.step_mm or plan.at_knots ask for it: at equal times, at equal distances, or at the knots
/// of the curve; in each case at both ends too. Otherwise the fewest waypoints whose straight moves stay within
/// plan.chord_tolerance_mm of the curve, and between which the torch nowhere turns by more than plan.max_turn_deg;
/// equally spaced where that needs no more of them.
///
/// Greedy from the start gives f_k, the furthest station that k moves reach, and greedy from the end b_k, the first
/// station from which N - k moves reach the end. Where N equal steps do not hold, the limits are tightened as far as N
/// moves allow, and station f_k - (f_k - b_k) k / N spreads what slack is left: the same waypoints whichever end the
/// seam starts from. Where the speed changes, some more are put in (SpeedProfile::changes()). A corner has a waypoint
/// unless times are equal, and those between two corners are chosen as if there was nothing else. The curve under each
/// chord is held by samples so close that a bound of what lies between them
/// (|c''| du^2 / 8) is small, and is added to their distance.
/// Throws InputError where the torch direction jumps, so that no move is short enough.
WeldPoses weld_poses(const TorchPath& path, const Samples& samples, const SpeedProfile& profile,
                     const PlanOptions& options);

}  // namespace seampath::planning
