#include "stages/export/parts.hpp"

#include "stages/error.hpp"

namespace seampath::exporting {

std::vector<Section> welds_of(const std::vector<Target>& targets) {
    std::vector<Section> welds;
    for (std::size_t k = 0; k < targets.size(); ++k) {
        const bool starts =
            k == 0 || targets[k].at.seam != targets[k - 1].at.seam ||
            (targets[k - 1].at.kind == WaypointKind::retract && targets[k].at.kind != WaypointKind::retract);
        if (starts) {
            welds.push_back({k, k});
        }
        welds.back().end = k + 1;
    }
    return welds;
}

std::vector<Section> parts_of(const std::vector<Target>& targets, const std::vector<Section>& welds,
                              const std::vector<std::size_t>& lines, std::size_t head, std::size_t most,
                              std::string_view robot) {
    std::vector<Section> parts;
    std::size_t filled = 0;
    for (std::size_t i = 0; i < welds.size(); ++i) {
        if (head + lines[i] > most) {
            throw InputError("export: " + std::string(robot) + ": seam " +
                             std::to_string(targets[welds[i].begin].at.seam) + " makes " +
                             std::to_string(head + lines[i]) + " lines; at most " + std::to_string(most) +
                             " are needed for a program, and a weld is not split; raise plan.chord_tolerance_mm or "
                             "plan.max_turn_deg");
        }
        if (parts.empty() || filled + lines[i] > most) {
            parts.push_back({welds[i].begin, welds[i].begin});
            filled = head;
        }
        parts.back().end = welds[i].end;
        filled += lines[i];
    }
    return parts;
}

}  // namespace seampath::exporting
