#include <algorithm>
#include <string>

#include "stages/error.hpp"
#include "stages/export/text.hpp"

/// ABB RAPID. One module with a procedure per seam and a main that calls them; above 5000 lines one module per seam,
/// since a weld is never split. Positions in mm with 3 decimals, quaternions w, x, y, z with 8 (an unnormalised one
/// sends the robot tens of mm wrong), external axes 9E9, configuration not supervised. With seam and weld data named:
/// ArcLStart, ArcL, ArcLEnd; without: MoveL. Tool, work object, zone, seam and weld data are referred to by name and
/// live on the controller.
namespace seampath::exporting {
namespace {

constexpr std::size_t kMaxLines = 5000;      // of a module; a teach pendant's editor copes with these
constexpr std::size_t kMaxName = 32;         // characters of an identifier
constexpr std::size_t kMaxProgramName = 24;  // leaves room for "_seam123"

const std::vector<std::string_view>& reserved() {
    static const std::vector<std::string_view> words{
        "alias",  "and",     "backward", "case",  "connect",   "const",   "default",   "div",     "do",      "else",
        "elseif", "endfor",  "endfunc",  "endif", "endmodule", "endproc", "endrecord", "endtest", "endtrap", "endwhile",
        "error",  "exit",    "false",    "for",   "from",      "func",    "goto",      "if",      "inout",   "local",
        "mod",    "module",  "nostepin", "not",   "noview",    "or",      "pers",      "proc",    "raise",   "readonly",
        "record", "retry",   "return",   "step",  "sysmodule", "task",    "test",      "then",    "to",      "trap",
        "true",   "trynext", "undo",     "var",   "viewonly",  "while",   "with",      "xor"};
    return words;
}

// A program can't take these either: the controller has them, or the program itself uses them.
const std::vector<std::string_view>& reserved_for_program() {
    static const std::vector<std::string_view> words = [] {
        std::vector<std::string_view> all = reserved();
        all.insert(all.end(),
                   {"main", "fine", "tool0", "wobj0", "load0", "movel", "movej", "arcl", "arclstart", "arclend",
                    "confl", "confj", "speeddata", "robtarget", "tooldata", "wobjdata", "zonedata", "user", "base"});
        return all;
    }();
    return words;
}

bool with_arc(const ExportOptions& options) {
    return !options.abb_seam_data.empty();
}

std::string robtarget(const Waypoint& w) {
    return "[[" + fixed(w.p.x(), 3) + "," + fixed(w.p.y(), 3) + "," + fixed(w.p.z(), 3) + "],[" + fixed(w.q.w(), 8) +
           "," + fixed(w.q.x(), 8) + "," + fixed(w.q.y(), 8) + "," + fixed(w.q.z(), 8) +
           "],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]";
}

// Speeds of the plan, in order of first use; each becomes a speeddata of its own.
std::vector<double> speeds_of(const std::vector<Waypoint>& waypoints) {
    std::vector<double> speeds;
    for (const Waypoint& w : waypoints) {
        if (std::find(speeds.begin(), speeds.end(), w.speed_mm_s) == speeds.end()) {
            speeds.push_back(w.speed_mm_s);
        }
    }
    return speeds;
}

// With the reorientation and external axis speeds of RAPID's own v data.
std::string speed_lines(const std::vector<double>& speeds) {
    std::string text;
    for (std::size_t i = 0; i < speeds.size(); ++i) {
        text += "  LOCAL CONST speeddata speed" + std::to_string(i) + ":=[" + plain(speeds[i]) + ",500,5000,1000];\n";
    }
    return text;
}

std::string instruction(const Waypoint& w, bool first, const ExportOptions& options) {
    if (with_arc(options)) {
        switch (w.kind) {
            case WaypointKind::weld_start:
                return "ArcLStart";
            case WaypointKind::weld:
                return "ArcL";
            case WaypointKind::weld_end:
                return "ArcLEnd";
            default:
                break;
        }
    }
    // Where the robot comes from is not known: the first move is along its axes.
    return first ? "MoveJ" : "MoveL";
}

std::string move(const Waypoint& w, bool first, const std::vector<double>& speeds, const ExportOptions& options) {
    const std::string name = instruction(w, first, options);
    const auto speed = std::find(speeds.begin(), speeds.end(), w.speed_mm_s) - speeds.begin();
    const std::string process =
        name.starts_with("ArcL") ? "," + options.abb_seam_data + "," + options.abb_weld_data : std::string();
    const std::string zone = w.kind == WaypointKind::weld ? options.abb_zone : "fine";
    return "    " + name + " " + robtarget(w) + ",speed" + std::to_string(speed) + process + "," + zone + "," +
           options.abb_tool + "\\WObj:=" + options.abb_work_object + ";\n";
}

struct Procedure {
    std::string name;
    std::string text;
};

std::vector<Procedure> procedures(const Plan& in_base, const std::vector<double>& speeds,
                                  const ExportOptions& options) {
    std::vector<Procedure> result;
    for (std::size_t k = 0; k < in_base.waypoints.size(); ++k) {
        const Waypoint& w = in_base.waypoints[k];
        if (k == 0 || w.seam != in_base.waypoints[k - 1].seam) {
            const std::string name = options.program_name + "_seam" + std::to_string(w.seam);
            result.push_back({name, "  PROC " + name + "()\n    ConfL\\Off;\n    ConfJ\\Off;\n"});
        }
        result.back().text += move(w, k == 0, speeds, options);
    }
    for (Procedure& procedure : result) {
        procedure.text += "  ENDPROC\n";
    }
    return result;
}

std::string head(const Plan& in_base, const ExportOptions& options) {
    std::string text;
    for (const std::string& line : preamble(in_base, options, kAbbRounding_mm)) {
        text += "  ! " + line + "\n";
    }
    text += "  ! Units: mm, mm/s; quaternions w, x, y, z. Positions are those of " + options.abb_tool + " in " +
            options.abb_work_object + ".\n";
    if (with_arc(options)) {
        text += "  ! While welding the robot takes its speed from weld_speed of " + options.abb_weld_data +
                "; the plan's is in the speed data.\n";
    }
    return text;
}

std::string main_procedure(const std::vector<Procedure>& seams) {
    std::string text = "  PROC main()\n";
    for (const Procedure& seam : seams) {
        text += "    " + seam.name + ";\n";
    }
    return text + "  ENDPROC\n";
}

std::string module(const std::string& name, const std::string& body) {
    return "MODULE " + name + "\n" + body + "ENDMODULE\n";
}

std::size_t lines(const std::string& text) {
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace

Told abb_told(const ExportOptions& options) {
    return with_arc(options) ? Told::welding : Told::motion;
}

std::vector<std::string> abb_problems(const ExportOptions& options) {
    std::vector<std::string> problems =
        name_problems("program_name", options.program_name, kMaxProgramName, reserved_for_program(), "RAPID");
    const auto check = [&](std::string_view key, const std::string& value) {
        const auto found = name_problems(key, value, kMaxName, reserved(), "RAPID");
        problems.insert(problems.end(), found.begin(), found.end());
    };
    check("abb_tool", options.abb_tool);
    check("abb_work_object", options.abb_work_object);
    check("abb_zone", options.abb_zone);
    if (options.abb_seam_data.empty() != options.abb_weld_data.empty()) {
        problems.push_back("abb_seam_data: \"" + options.abb_seam_data + "\" and abb_weld_data \"" +
                           options.abb_weld_data + "\"; both were needed for arc welding, or neither");
    } else if (with_arc(options)) {
        check("abb_seam_data", options.abb_seam_data);
        check("abb_weld_data", options.abb_weld_data);
    }
    return problems;
}

std::vector<TextFile> write_abb(const Plan& in_base, const ExportOptions& options) {
    const std::vector<double> speeds = speeds_of(in_base.waypoints);
    const std::vector<Procedure> seams = procedures(in_base, speeds, options);
    const std::string& name = options.program_name;
    const std::string data = head(in_base, options) + speed_lines(speeds);
    std::string body = data + main_procedure(seams);
    for (const Procedure& seam : seams) {
        body += seam.text;
    }
    const std::string whole = module(name, body);
    if (lines(whole) <= kMaxLines) {
        return {{name + ".mod", whole}};
    }
    std::vector<TextFile> files{{name + ".mod", module(name, "  ! Needs the modules of all seams loaded beside it.\n" +
                                                                 head(in_base, options) + main_procedure(seams))}};
    for (std::size_t i = 0; i < seams.size(); ++i) {
        const std::string part = name + "_mod" + std::to_string(i);
        files.push_back({part + ".mod", module(part, data + seams[i].text)});
        if (const std::size_t count = lines(files.back().text); count > kMaxLines) {
            throw InputError("export: abb: seam " + std::to_string(i) + " makes " + std::to_string(count) +
                             " lines; at most " + std::to_string(kMaxLines) +
                             " are needed for a module, and a weld is not split; raise plan.chord_tolerance_mm or "
                             "plan.max_turn_deg");
        }
    }
    return files;
}

}  // namespace seampath::exporting
