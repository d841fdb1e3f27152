#pragma once

#include <vector>

#include "pipeline/compare.hpp"

namespace seampath {

/// Which seams of two runs are one, by where they lie, and how far apart they run; in the order of run A.
std::vector<SeamPair> pair_seams(const ComparedRun& a, const ComparedRun& b);

}  // namespace seampath
