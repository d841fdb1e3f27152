#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "stages/export/format.hpp"

/// Private to the export stage: programs that are too long for a controller, in parts that a main program calls.
namespace seampath::exporting {

/// Targets [begin, end).
struct Section {
    std::size_t begin = 0;
    std::size_t end = 0;
};

/// From each way towards a weld to the way back: what must stay in one part.
std::vector<Section> welds_of(const std::vector<Target>& targets);

/// As few parts as hold at most `most` lines each, made of whole welds; `lines` is of each, `head` what every part has
/// besides. Throws InputError where one weld alone has more.
std::vector<Section> parts_of(const std::vector<Target>& targets, const std::vector<Section>& welds,
                              const std::vector<std::size_t>& lines, std::size_t head, std::size_t most,
                              std::string_view robot);

}  // namespace seampath::exporting
