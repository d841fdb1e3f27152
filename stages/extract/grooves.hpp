#pragma once

#include <string>
#include <vector>

#include "stages/extract/around.hpp"
#include "stages/types.hpp"

namespace seampath::detail {

/// V-grooves, with or without root gap and root face, and single bevels.
struct Grooves {
    std::vector<Seam> seams;
    std::vector<char> claimed;  ///< one a crease of Around: part of a groove, and no joint of its own
    double registration_mm = 0;
    std::vector<std::string> remarks;
};

/// Pairs of bevels that face each other between two level tops, followed along the groove and measured as sections of
/// it, at least `min_length_mm` long; 0: as long as tells a joint from chance.
Grooves find_grooves(const Around& around, double min_length_mm);

}  // namespace seampath::detail
