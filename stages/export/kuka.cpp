#include <algorithm>
#include <cmath>
#include <string>

#include "stages/error.hpp"
#include "stages/export/parts.hpp"
#include "stages/export/text.hpp"
#include "stages/geometry/pose.hpp"

/// KUKA KRL: a .src of moves and a .dat of their frames; above 1400 lines a main program and parts of whole welds.
/// Positions in mm with 3 decimals, angles A, B, C of Rz(A) Ry(B) Rx(C) in deg with 4, speeds in m/s. Through the air
/// PTP to axis angles where the arm is known. LIN and CIRC with C_DIS along welds, or spline blocks. The arc is struck
/// and ended by sub-programs of the user: what ArcTech's own inline forms hold depends on its version.
namespace seampath::exporting {
namespace kuka_writer {

constexpr std::size_t kMaxLines = 1400;  // what a teach pendant's editor copes with
constexpr std::size_t kMaxName = 24;
constexpr std::size_t kMaxProgramName = 20;  // leaves room for "_123"
constexpr double kRounding_mm = 0.0005;
constexpr double kMaxCoordinate_mm = 8388.607;  // a REAL has 24 bits: up to 2^23 thousandths

const std::vector<std::string_view>& reserved() {
    static const std::vector<std::string_view> words{
        "and",       "bas",     "bool",      "case",      "char",     "circ", "const",  "continue", "decl",
        "def",       "default", "defdat",    "deffct",    "else",     "end",  "enddat", "endfct",   "endfor",
        "endif",     "endloop", "endspline", "endswitch", "endwhile", "enum", "exit",   "ext",      "extfct",
        "false",     "for",     "frame",     "global",    "goto",     "halt", "if",     "import",   "int",
        "interrupt", "is",      "lin",       "loop",      "not",      "or",   "pos",    "ptp",      "public",
        "real",      "repeat",  "return",    "scirc",     "signal",   "slin", "spl",    "spline",   "sptp",
        "struc",     "switch",  "then",      "to",        "trigger",  "true", "until",  "wait",     "when",
        "while",     "with"};
    return words;
}

bool with_arc(const ExportOptions& options) {
    return !options.kuka_arc_on.empty();
}

std::string frame(const Waypoint& w) {
    const Eigen::Vector3d abc = euler_zyx(w.q);
    return "{X " + fixed(w.p.x(), 3) + ",Y " + fixed(w.p.y(), 3) + ",Z " + fixed(w.p.z(), 3) + ",A " +
           degrees(abc[0], 4) + ",B " + degrees(abc[1], 4) + ",C " + degrees(abc[2], 4) + "}";
}

std::string axes(const AxisPoint& point) {
    std::vector<std::string> parts = axis_degrees(point.q, 4);
    for (std::size_t i = 0; i < parts.size(); ++i) {
        parts[i] = "A" + std::to_string(i + 1) + " " + parts[i];
    }
    return "{" + joined(parts, ",") + "}";
}

std::string metres_per_second(double mm_s) {
    // Nine digits are more than the controller's 24 bits hold.
    const int decimals = 8 - static_cast<int>(std::floor(std::log10(mm_s / 1000)));
    std::string text = fixed(mm_s / 1000, std::clamp(decimals, 1, 20));
    text.erase(text.find_last_not_of('0') + 1);
    return text.back() == '.' ? text + "0" : text;
}

bool is_welding(const Target& target) {
    return target.at.kind == WaypointKind::weld || target.at.kind == WaypointKind::weld_end;
}

// Moves of one part, and the frames that they go to.
class Writer {
public:
    Writer(const std::vector<Target>& targets, const ExportOptions& options) : all_(targets), options_(options) {}

    void write(const Section& part) {
        for (std::size_t k = part.begin; k < part.end; ++k) {
            const Target& target = all_[k];
            const std::string point = " P" + std::to_string(count_) + "=";
            data += (target.axes.empty() ? "DECL FRAME" + point + frame(target.at)
                                         : "DECL E6AXIS" + point + axes(target.axes.back())) +
                    "\n";
            ++count_;
            if (target.move != Move::via) {
                move(k);
            }
            if (target.at.kind == WaypointKind::weld_start) {
                process(options_.kuka_arc_on);
            } else if (target.at.kind == WaypointKind::weld_end) {
                process(options_.kuka_arc_off);
            }
        }
    }
    std::string moves, data;

private:
    void move(std::size_t k) {
        const Target& target = all_[k];
        const std::string last = "P" + std::to_string(count_ - 1);
        if (target.move == Move::joint) {
            moves += "BAS(#VEL_PTP," + plain(options_.joint_speed_percent) + ")\nPTP " + last + "\n";
            return;
        }
        const bool spline = options_.kuka_spline && is_welding(target);
        const bool first = spline && !is_welding(all_[k - (target.move == Move::circular ? 2 : 1)]);
        if (first) {
            moves += "SPLINE WITH $VEL.CP=" + metres_per_second(target.at.speed_mm_s) + "\n";
        } else if (!spline && target.at.speed_mm_s != speed_) {
            moves += "$VEL.CP=" + metres_per_second(target.at.speed_mm_s) + "\n";
        }
        moves += spline ? "S" : "";
        moves += target.move == Move::circular ? "CIRC P" + std::to_string(count_ - 2) + "," + last : "LIN " + last;
        if (spline) {
            moves += first || target.at.speed_mm_s == spline_speed_
                         ? ""
                         : " WITH $VEL.CP=" + metres_per_second(target.at.speed_mm_s);
            moves += target.at.kind == WaypointKind::weld_end ? "\nENDSPLINE" : "";
            spline_speed_ = first ? target.at.speed_mm_s : spline_speed_;
        } else {
            moves += target.at.kind == WaypointKind::weld ? " C_DIS" : "";
            speed_ = target.at.speed_mm_s;
        }
        moves += "\n";
    }

    // The wait keeps the controller from calling ahead of the motion.
    void process(const std::string& sub_program) {
        if (with_arc(options_)) {
            moves += "WAIT SEC 0\n" + sub_program + "()\n";
        }
    }

    const std::vector<Target>& all_;
    const ExportOptions& options_;
    std::size_t count_ = 0;
    double speed_ = 0;
    double spline_speed_ = 0;
};

constexpr std::string_view kHeader =
    "&ACCESS RVP\n&REL 1\n&PARAM TEMPLATE = C:\\KRC\\Roboter\\Template\\vorgabe\n&PARAM EDITMASK = *\n";

std::string set_up(const Program& program, const ExportOptions& options) {
    std::string text;
    for (const std::string& line : preamble(program, options, kRounding_mm)) {
        text += "; " + line + "\n";
    }
    const std::string tool = plain(*options.kuka_tool);
    text += "; Units: mm, deg, m/s; A, B, C about Z, Y, X.\nBAS(#INITMOV,0)\n";
    text += "$TOOL=TOOL_DATA[" + tool + "]\n$LOAD=LOAD_DATA[" + tool + "]\n";
    text += options.kuka_base ? "$BASE=BASE_DATA[" + plain(*options.kuka_base) + "]\n" : "$BASE=$NULLFRAME\n";
    // Orientations turn evenly from start to end, on arcs as on lines, whatever the point on the way has.
    return text + "$ORI_TYPE=#VAR\n$CIRC_TYPE=#BASE\n$APO.CDIS=" + plain(options.kuka_approximation_mm) + "\n";
}

std::vector<TextFile> module(const std::string& name, const std::string& statements, const std::string& data) {
    const std::string header(kHeader);
    return {{name + ".src", crlf(header + "DEF " + name + "()\n" + statements + "END\n")},
            {name + ".dat", crlf(header + "DEFDAT " + name + "\n" + data + "ENDDAT\n")}};
}

Told told(const ExportOptions& options) {
    return with_arc(options) ? Told::welding : Told::motion;
}

std::vector<std::string> problems(const ExportOptions& options) {
    std::vector<std::string> found =
        name_problems("program_name", options.program_name, kMaxProgramName, reserved(), "KRL");
    if (is_numbered(lower(options.program_name), "p")) {
        found.push_back("program_name: \"" + options.program_name +
                        "\" is what the program's points are called; another name was needed");
    }
    append(found, needed_number_problems("kuka_tool", options.kuka_tool, 1, 128, "number of a tool"));
    append(found, number_problems("kuka_base", options.kuka_base, 1, 128, "number of a base"));
    if (options.kuka_arc_on.empty() != options.kuka_arc_off.empty()) {
        found.push_back("kuka_arc_on: \"" + options.kuka_arc_on + "\" and kuka_arc_off \"" + options.kuka_arc_off +
                        "\"; both were needed for arc welding, or neither");
    } else if (with_arc(options)) {
        append(found, name_problems("kuka_arc_on", options.kuka_arc_on, kMaxName, reserved(), "KRL"));
        append(found, name_problems("kuka_arc_off", options.kuka_arc_off, kMaxName, reserved(), "KRL"));
        const std::string on = lower(options.kuka_arc_on), off = lower(options.kuka_arc_off);
        const std::string program = lower(options.program_name);
        const auto is_the_programs = [&](const std::string& name) {
            return name == program || is_numbered(name, "p") || is_numbered(name, program + "_");
        };
        if (on == off || is_the_programs(on) || is_the_programs(off)) {
            found.push_back("kuka_arc_on: \"" + options.kuka_arc_on + "\", kuka_arc_off \"" + options.kuka_arc_off +
                            "\" and program_name \"" + options.program_name +
                            "\"; three different names were needed, and none as the program's points and parts have");
        }
    }
    return found;
}

std::vector<TextFile> write(const Program& program, const ExportOptions& options) {
    const std::vector<Target>& all = program.targets;
    const std::string head = set_up(program, options);
    const std::vector<Section> welds = welds_of(all);
    std::vector<std::size_t> lines;
    for (const Section& weld : welds) {
        Writer writer(all, options);
        writer.write(weld);
        lines.push_back(std::max(line_count(writer.moves), line_count(writer.data)));
    }
    constexpr std::size_t kFrame = 6;  // header, DEF and END
    const std::vector<Section> parts = parts_of(all, welds, lines, kFrame + line_count(head), kMaxLines, "kuka");
    const std::string& name = options.program_name;
    if (parts.size() == 1) {
        Writer writer(all, options);
        writer.write(parts.front());
        return module(name, head + writer.moves, writer.data);
    }
    std::string calls = head;
    std::vector<TextFile> files(2);
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const std::string part = name + "_" + std::to_string(i);
        calls += part + "()\n";
        Writer writer(all, options);
        writer.write(parts[i]);
        for (TextFile& file : module(part, writer.moves, writer.data)) {
            files.push_back(std::move(file));
        }
    }
    std::vector<TextFile> main = module(name, calls, "");
    std::move(main.begin(), main.end(), files.begin());
    return files;
}

}  // namespace kuka_writer

constinit const Format kKuka{"kuka",
                             kuka_writer::kRounding_mm,
                             kuka_writer::kMaxCoordinate_mm,
                             0,
                             true,
                             true,
                             Axes::air,
                             true,
                             kuka_writer::told,
                             kuka_writer::problems,
                             kuka_writer::write,
                             read_kuka};

}  // namespace seampath::exporting
