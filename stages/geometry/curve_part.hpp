#pragma once

#include <vector>

#include "stages/types.hpp"

/// Other curves along the same way as a CubicBSpline (types.hpp).
namespace seampath {

/// The same curve from its other end.
CubicBSpline reversed(const CubicBSpline& curve);

/// The curve from parameter `from` to `to` (> from) as an open one with the same parameter, to rounding; a periodic
/// curve may be gone round more than once. `before` and `behind`, mm, add straight pieces along the tangents at its
/// ends.
CubicBSpline part_of(const CubicBSpline& curve, double from, double to, double before = 0, double behind = 0);

/// Open curves, each of which begins where the one before ends, as one that shares only its position there; `closed`:
/// so do its ends. The parameter goes on from that of the first.
CubicBSpline joined(const std::vector<CubicBSpline>& parts, bool closed);

}  // namespace seampath
