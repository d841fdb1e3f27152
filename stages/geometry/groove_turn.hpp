#pragma once

#include <optional>
#include <span>

#include "stages/geometry/groove_section.hpp"

namespace seampath {

/// Where a bevel that seems to end about `end` is seen to turn upright, into its root face: the face's first points lie
/// close to the bevel's line and make its end seem deeper. `gate` is how close, mm; points are carried back along
/// `drift`. The face is taken to be square to the plate's top, as it is prepared. Empty where no root face is seen, or
/// the side has no bevel; without shares.
std::optional<BevelDepth> bevel_turn(std::span<const GroovePoint> points, const Eigen::Vector2d& drift,
                                     const GrooveFit& fit, std::size_t side, const Eigen::Vector2d& end,
                                     const ScanScale& scale, double gate);

}  // namespace seampath
