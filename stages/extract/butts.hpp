#pragma once

#include <string>
#include <vector>

#include "stages/extract/around.hpp"
#include "stages/extract/borders.hpp"
#include "stages/types.hpp"

namespace seampath::detail {

struct Butts {
    std::vector<Seam> seams;
    std::vector<std::string> remarks;
};

/// Butt joints: gaps between the borders of two sheets that are parallel and nearly level, at least `min_length_mm`
/// long; 0: as long as tells a joint from chance.
Butts find_butts(const Around& around, const std::vector<Border>& borders, double min_length_mm);

}  // namespace seampath::detail
