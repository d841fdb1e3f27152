#include <string>

#include "stages/export/text.hpp"

/// Tool paths of noether (ros-industrial) as YAML: a list of paths, one a weld, of a list of segments, one each, of
/// poses x, y, z in metres and qw, qx, qy, qz. Speeds, and the ways to and from a weld, are its planner's.
namespace seampath::exporting {
namespace noether_writer {

constexpr std::size_t kMaxName = 64;
constexpr double kRounding_mm = 5e-10;  // twelve decimals of a metre

std::vector<Target> prepare(std::vector<Target> targets) {
    std::erase_if(targets, [](const Target& target) {
        const WaypointKind kind = target.at.kind;
        return kind != WaypointKind::weld_start && kind != WaypointKind::weld && kind != WaypointKind::weld_end;
    });
    return targets;
}

Told told(const ExportOptions&) {
    return Told::welding;
}

std::vector<std::string> problems(const ExportOptions& options) {
    return name_problems("program_name", options.program_name, kMaxName, {}, "noether");
}

std::vector<TextFile> write(const Program& program, const ExportOptions& options) {
    std::string text;
    for (const std::string& line : preamble(program, options, kRounding_mm)) {
        text += "# " + line + "\n";
    }
    text += "# Units: m. Only welds; no speeds.\n[\n";
    for (const Target& target : program.targets) {
        const Waypoint& w = target.at;
        const auto part = [](const char* name, double value) { return name + fixed(value, 12); };
        text += w.kind == WaypointKind::weld_start ? "[[\n" : "";
        text += part("{x: ", w.p.x() / 1000) + part(", y: ", w.p.y() / 1000) + part(", z: ", w.p.z() / 1000) +
                part(", qw: ", w.q.w()) + part(", qx: ", w.q.x()) + part(", qy: ", w.q.y()) + part(", qz: ", w.q.z()) +
                "}";
        const bool last = &target == &program.targets.back();
        text += w.kind != WaypointKind::weld_end ? ",\n" : last ? "\n]]\n" : "\n]],\n";
    }
    return {{options.program_name + "_tool_paths.yaml", text + "]\n"}};
}

}  // namespace noether_writer

constinit const Format kNoether{"noether",
                                noether_writer::kRounding_mm,
                                kAnywhere,
                                0,
                                false,
                                false,
                                Axes::none,
                                false,
                                noether_writer::told,
                                noether_writer::problems,
                                noether_writer::write,
                                read_noether,
                                noether_writer::prepare};

}  // namespace seampath::exporting
