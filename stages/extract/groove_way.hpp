#pragma once

#include <optional>
#include <vector>

#include "stages/extract/around.hpp"
#include "stages/geometry/groove_section.hpp"

namespace seampath::detail {

/// A place of a groove that is being followed.
struct GroovePlace {
    GrooveFrame frame;  ///< p on the root
    GrooveFit fit;
    GrooveNumbers numbers;
};

/// A groove from end to end, in the direction of travel.
struct GrooveWay {
    bool closed = false;
    std::vector<GroovePlace> places;
    GrooveRoot root;
};

/// Where following begins: two creases of tops and bevels that face each other.
struct GrooveSeed {
    GrooveFrame frame;
    GrooveShape shape;
};

/// Follows the groove from the seed both ways until one of its bevels ends, or it comes back to its start. Empty when
/// the seed does not measure as a groove.
std::optional<GrooveWay> follow_groove(const Tracker& following, const GrooveSeed& seed);

/// The way measured anew with wide windows: places at equal steps along it, ends where the first bevel ends. Empty when
/// it turns out to be no groove.
std::optional<GrooveWay> measure_groove(const Tracker& following, const GrooveWay& way);

}  // namespace seampath::detail
