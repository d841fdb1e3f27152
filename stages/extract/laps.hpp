#pragma once

#include <string>
#include <vector>

#include "stages/extract/around.hpp"
#include "stages/extract/borders.hpp"
#include "stages/types.hpp"

namespace seampath::detail {

struct LapsAsked {
    double max_step_mm = 0;    ///< a step no higher is machined: no joint
    bool by_any_step = false;  ///< the user says that steps are laps: neither width nor what lies below counts
    double min_length_mm = 0;  ///< 0: as long as tells a joint from chance
};

/// Lap joints, and the tracks that they or edges on a table explain: these are no fillets.
struct Laps {
    std::vector<Seam> seams;
    std::vector<Track> tracks;
    double registration_mm = 0;
    std::vector<std::string> remarks;
};

/// Lap joints: the border of a sheet with a parallel sheet below it. Three things tell one from what looks like it. A
/// step no higher than max_step_mm was machined. What is less than three times as wide as it is high is a web, a box or
/// a pipe that stands on a plate. And a surface that shows no side face at any border of its own is a table, on which
/// the plate lies.
Laps find_laps(const Around& around, const std::vector<Border>& borders, const LapsAsked& asked);

}  // namespace seampath::detail
