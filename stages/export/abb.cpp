#include <algorithm>
#include <string>

#include "stages/error.hpp"
#include "stages/export/text.hpp"

/// ABB RAPID. One module with a procedure per seam and a main that calls them; above 5000 lines one module per seam,
/// since a weld is never split. Positions in mm with 3 decimals, quaternions w, x, y, z with 8 (an unnormalised one
/// sends the robot tens of mm wrong), external axes 9E9, configuration not supervised. Through the air MoveAbsJ where
/// the arm is known. With seam and weld data named: ArcLStart, ArcL, ArcC, ArcLEnd; without: MoveL, MoveC. Tool, work
/// object, zone, seam, weld and weave data are referred to by name and live on the controller.
namespace seampath::exporting {
namespace abb_writer {

constexpr std::size_t kMaxLines = 5000;      // of a module; a teach pendant's editor copes with these
constexpr std::size_t kMaxName = 32;         // characters of an identifier
constexpr std::size_t kMaxProgramName = 24;  // leaves room for "_seam123"
constexpr double kRounding_mm = 0.0005;
constexpr double kMaxCoordinate_mm = 8388.607;  // up to 2^23 thousandths the 24 bits of a num hold every third decimal

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
                   {"main",      "fine",      "tool0",    "wobj0",    "load0",    "movel", "movej",   "arcl",
                    "arclstart", "arclend",   "confl",    "confj",    "movec",    "arcc",  "arccend", "cirpathmode",
                    "speeddata", "robtarget", "tooldata", "wobjdata", "zonedata", "user",  "base"});
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

std::string jointtarget(const AxisPoint& axes) {
    return "[[" + joined(axis_degrees(axes.q, 4), ",") + "],[9E9,9E9,9E9,9E9,9E9,9E9]]\\NoEOffs";
}

// Speeds of the plan, in order of first use; each becomes a speeddata of its own.
std::vector<double> speeds_of(const std::vector<Target>& targets) {
    std::vector<double> speeds;
    for (const Target& target : targets) {
        if (std::find(speeds.begin(), speeds.end(), target.at.speed_mm_s) == speeds.end()) {
            speeds.push_back(target.at.speed_mm_s);
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

std::string instruction(const Target& target, const ExportOptions& options) {
    const bool circular = target.move == Move::circular;
    if (with_arc(options)) {
        switch (target.at.kind) {
            case WaypointKind::weld_start:
                return "ArcLStart";
            case WaypointKind::weld:
                return circular ? "ArcC" : "ArcL";
            case WaypointKind::weld_end:
                return circular ? "ArcCEnd" : "ArcLEnd";
            default:
                break;
        }
    }
    return !target.axes.empty() ? "MoveAbsJ" : target.move == Move::joint ? "MoveJ" : circular ? "MoveC" : "MoveL";
}

// `via` is the point on the way of a circular move, otherwise nullptr.
std::string move(const Target* via, const Target& target, const std::vector<double>& speeds,
                 const ExportOptions& options) {
    const Waypoint& w = target.at;
    const std::string name = instruction(target, options);
    const auto speed = std::find(speeds.begin(), speeds.end(), w.speed_mm_s) - speeds.begin();
    std::string text = "    " + name + " " + (via != nullptr ? robtarget(via->at) + "," : "") +
                       (target.axes.empty() ? robtarget(w) : jointtarget(target.axes.back())) + ",speed" +
                       std::to_string(speed);
    if (name.starts_with("Arc")) {
        text += "," + options.abb_seam_data + "," + options.abb_weld_data +
                (options.abb_weave_data.empty() ? "" : "\\Weave:=" + options.abb_weave_data);
    }
    const std::string zone = w.kind == WaypointKind::weld ? options.abb_zone : "fine";
    return text + "," + zone + "," + options.abb_tool + "\\WObj:=" + options.abb_work_object + ";\n";
}

struct Procedure {
    std::string name;
    std::string text;
};

std::vector<Procedure> procedures(const std::vector<Target>& targets, const std::vector<double>& speeds,
                                  const ExportOptions& options) {
    const bool arcs = std::any_of(targets.begin(), targets.end(), [](const Target& t) { return t.move == Move::via; });
    std::vector<Procedure> result;
    for (std::size_t k = 0; k < targets.size(); ++k) {
        const int seam = targets[k].at.seam;
        if (k == 0 || seam != targets[k - 1].at.seam) {
            const std::string name = options.program_name + "_seam" + std::to_string(seam);
            // On arcs the orientation goes from start to end in the work object, as on lines.
            result.push_back({name, "  PROC " + name + "()\n    ConfL\\Off;\n    ConfJ\\Off;\n" +
                                        (arcs ? "    CirPathMode\\ObjectFrame;\n" : "")});
        }
        if (targets[k].move != Move::via) {
            const bool circular = targets[k].move == Move::circular;
            result.back().text += move(circular ? &targets[k - 1] : nullptr, targets[k], speeds, options);
        }
    }
    for (Procedure& procedure : result) {
        procedure.text += "  ENDPROC\n";
    }
    return result;
}

std::string head(const Program& program, const ExportOptions& options) {
    std::string text;
    for (const std::string& line : preamble(program, options, kRounding_mm)) {
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

Told told(const ExportOptions& options) {
    return with_arc(options) ? Told::welding : Told::motion;
}

// Data under a name that the program itself declares would be hidden by it. Names are not case-sensitive.
bool is_the_programs(const std::string& value, const std::string& program) {
    const std::string name = lower(value), own = lower(program);
    return name == own || is_numbered(name, "speed") || is_numbered(name, own + "_seam") ||
           is_numbered(name, own + "_mod");
}

std::vector<std::string> problems(const ExportOptions& options) {
    std::vector<std::string> found =
        name_problems("program_name", options.program_name, kMaxProgramName, reserved_for_program(), "RAPID");
    const auto check = [&](std::string_view key, const std::string& value) {
        append(found, name_problems(key, value, kMaxName, reserved(), "RAPID"));
        if (is_the_programs(value, options.program_name)) {
            found.push_back(std::string(key) + ": \"" + value +
                            "\" is a name that the program itself declares; another "
                            "name was needed, or another program_name");
        }
    };
    if (is_numbered(lower(options.program_name), "speed")) {
        found.push_back("program_name: \"" + options.program_name +
                        "\" is what the program's speeds are called; another name was needed");
    }
    check("abb_tool", options.abb_tool);
    check("abb_work_object", options.abb_work_object);
    check("abb_zone", options.abb_zone);
    if (options.abb_seam_data.empty() != options.abb_weld_data.empty()) {
        found.push_back("abb_seam_data: \"" + options.abb_seam_data + "\" and abb_weld_data \"" +
                        options.abb_weld_data + "\"; both were needed for arc welding, or neither");
    } else if (with_arc(options)) {
        check("abb_seam_data", options.abb_seam_data);
        check("abb_weld_data", options.abb_weld_data);
    }
    if (!options.abb_weave_data.empty()) {
        check("abb_weave_data", options.abb_weave_data);
        if (!with_arc(options)) {
            found.push_back("abb_weave_data: \"" + options.abb_weave_data +
                            "\" stands alone; abb_seam_data and abb_weld_data were needed with it");
        }
    }
    return found;
}

std::vector<TextFile> write(const Program& program, const ExportOptions& options) {
    const std::vector<double> speeds = speeds_of(program.targets);
    const std::vector<Procedure> seams = procedures(program.targets, speeds, options);
    const std::string& name = options.program_name;
    const std::string data = head(program, options) + speed_lines(speeds);
    std::string body = data + main_procedure(seams);
    for (const Procedure& seam : seams) {
        body += seam.text;
    }
    const std::string whole = module(name, body);
    if (lines(whole) <= kMaxLines) {
        return {{name + ".mod", whole}};
    }
    std::vector<TextFile> files{{name + ".mod", module(name, "  ! Needs the modules of all seams loaded beside it.\n" +
                                                                 head(program, options) + main_procedure(seams))}};
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

}  // namespace abb_writer

constinit const Format kAbb{"abb",
                            abb_writer::kRounding_mm,
                            abb_writer::kMaxCoordinate_mm,
                            0,
                            true,
                            true,
                            Axes::air,
                            true,
                            abb_writer::told,
                            abb_writer::problems,
                            abb_writer::write,
                            read_abb};

}  // namespace seampath::exporting
