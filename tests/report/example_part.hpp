#pragma once

#include "pipeline/result.hpp"

namespace seampath::test {

/// A finished part whose every number follows from formulas: a closed fillet seam around a pipe of radius 30 mm on a
/// plate, and a straight open one along a rib. The first has a gap that was bridged; `pass` says whether the second is
/// in tolerance.
PartResult example_part(bool pass = true);

/// A scan in which nothing was found.
PartResult part_without_seams();

}  // namespace seampath::test
