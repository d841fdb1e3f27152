#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "stages/error.hpp"
#include "stages/export/parts.hpp"
#include "stages/export/text.hpp"
#include "stages/geometry/pose.hpp"

/// Yaskawa INFORM: relative jobs (.jbi) of cartesian positions, mm with 3 decimals and angles Rx, Ry, Rz of
/// Rz(Rz) Ry(Ry) Rx(Rx) in deg with 4, as YRC1000 has them. What V= means is a parameter of the controller, so that the
/// unit is the user's to tell. A circular step is three MOVC, the first where the robot stands; a MOVL on the spot
/// parts two of them. Through the air pulses where the arm is known. Arc and weaving by file numbers. Above 2000 lines
/// a main job and parts of whole welds.
namespace seampath::exporting {
namespace yaskawa_writer {

constexpr std::size_t kMaxLines = 2000;      // of instructions
constexpr std::size_t kMaxProgramName = 28;  // of 32: leaves room for "_123"
constexpr std::size_t kMaxComment = 30;
constexpr double kRounding_mm = 0.0005;
constexpr double kMaxCoordinate_mm = 8388.607;
constexpr double kMaxSpeedRounding = 0.0049;
constexpr double kLeastPulses_per_deg = 500;  // half a pulse is a thousandth of a degree at most

struct Unit {
    std::string_view name;
    double per_mm_s;
    int decimals;
};
constexpr std::array<Unit, 4> kUnits{
    {{"mm/s", 1, 1}, {"cm/min", 6, 1}, {"m/min", 0.06, 2}, {"inch/min", 60 / 25.4, 1}}};
constexpr double kMaxSpeed_mm_s = 1500;

const Unit* unit_of(const ExportOptions& options) {
    const auto found = std::find_if(kUnits.begin(), kUnits.end(),
                                    [&](const Unit& unit) { return unit.name == options.yaskawa_speed_unit; });
    return found == kUnits.end() ? nullptr : &*found;
}

bool with_arc(const ExportOptions& options) {
    return options.yaskawa_arc_start.has_value();
}

std::string speed(const Target& target, const ExportOptions& options) {
    const Unit& unit = *unit_of(options);
    const double exact = target.at.speed_mm_s * unit.per_mm_s, step = std::pow(10, -unit.decimals);
    const double written = std::round(exact / step) * step;
    if (!(std::abs(written / exact - 1) <= kMaxSpeedRounding && target.at.speed_mm_s <= kMaxSpeed_mm_s)) {
        throw InputError("export: yaskawa: " + place(target.at) + " has a speed of " + plain(target.at.speed_mm_s) +
                         " mm/s; steps of " + fixed(step, unit.decimals) + " " + std::string(unit.name) +
                         " within 0.5 % of it, and at most 1500 mm/s, are needed; change plan.speed_mm_s or "
                         "plan.air_speed_mm_s");
    }
    return " V=" + fixed(exact, unit.decimals);
}

// Pulses of the axes' encoders.
std::string pulses(const AxisPoint& axes, const ExportOptions& options) {
    std::vector<std::string> parts;
    for (std::size_t i = 0; i < axes.q.size(); ++i) {
        parts.push_back(fixed(180 / std::numbers::pi * axes.q[i] * options.yaskawa_pulses_per_deg[i], 0));
    }
    return joined(parts, ",");
}

// Instructions and positions of one part.
class Writer {
public:
    Writer(const std::vector<Target>& targets, const ExportOptions& options) : all_(targets), options_(options) {}

    void line(const std::string& instruction) {
        ++lines;
        instructions += instruction + "\n";
    }

    void write(const Section& part) {
        for (std::size_t k = part.begin; k < part.end; ++k) {
            const Target& target = all_[k];
            if (target.move == Move::via) {
                // Back to where the robot stands.
                if (circular_) {
                    step("MOVL", all_[k - 1], speed(target, options_));
                }
                step("MOVC", all_[k - 1], speed(target, options_));
            }
            move(target);
            process(target.at.kind);
        }
    }
    std::string instructions, positions;
    std::size_t lines = 0, points = 0;

private:
    void step(const std::string& instruction, const Target& to, const std::string& how) {
        std::string number = std::to_string(points);
        number.insert(0, 5 - std::min<std::size_t>(5, number.size()), '0');
        ++points;
        const bool by_axes = !to.axes.empty();
        if (points == 1 || by_axes != by_axes_) {
            positions += by_axes ? pulse_heading() : pose_heading();
            by_axes_ = by_axes;
        }
        positions += "C" + number + "=" + (by_axes ? pulses(to.axes.back(), options_) : pose(to.at)) + "\n";
        line(instruction + " C" + number + how);
    }

    static std::string pose(const Waypoint& w) {
        const Eigen::Vector3d zyx = euler_zyx(w.q);
        return fixed(w.p.x(), 3) + "," + fixed(w.p.y(), 3) + "," + fixed(w.p.z(), 3) + "," + degrees(zyx[2], 4) + "," +
               degrees(zyx[1], 4) + "," + degrees(zyx[0], 4);
    }

    std::string pulse_heading() const {
        return "///TOOL " + plain(*options_.yaskawa_tool) + "\n///POSTYPE PULSE\n///PULSE\n";
    }

    std::string pose_heading() const {
        const auto& user = options_.yaskawa_user_frame;
        return (user ? "///USER " + plain(*user) + "\n" : "") + "///TOOL " + plain(*options_.yaskawa_tool) +
               "\n///POSTYPE " + (user ? "USER" : "BASE") + "\n///RECTAN\n///RCONF " + options_.yaskawa_configuration +
               "\n";
    }

    void move(const Target& target) {
        if (target.move == Move::joint) {
            circular_ = false;
            step("MOVJ", target, " VJ=" + fixed(options_.joint_speed_percent, 2));
            return;
        }
        circular_ = target.move != Move::linear;
        // PL=0 stops in the point; along a weld PL=1 is the least rounding.
        const bool stops = target.at.kind != WaypointKind::weld;
        step(circular_ ? "MOVC" : "MOVL", target, speed(target, options_) + (stops ? " PL=0" : " PL=1"));
    }

    void process(WaypointKind kind) {
        const bool start = kind == WaypointKind::weld_start, end = kind == WaypointKind::weld_end;
        if (!with_arc(options_) || !(start || end)) {
            return;
        }
        const auto& weave = options_.yaskawa_weave;
        if (start) {
            line("ARCON ASF#(" + plain(*options_.yaskawa_arc_start) + ")");
        }
        if (weave) {
            line(start ? "WVON WEV#(" + plain(*weave) + ")" : "WVOF");
        }
        if (end) {
            line("ARCOF AEF#(" + plain(*options_.yaskawa_arc_end) + ")");
        }
    }

    const std::vector<Target>& all_;
    const ExportOptions& options_;
    bool circular_ = false;
    bool by_axes_ = false;  // the last position was
};

TextFile file(const std::string& name, const Writer& writer, const ExportOptions& options) {
    const auto& user = options.yaskawa_user_frame;
    std::string text = "/JOB\n//NAME " + name + "\n//POS\n///NPOS " + std::to_string(writer.points) + ",0,0,0,0,0\n";
    text += writer.positions;
    text += "//INST\n///DATE 1970/01/01 00:00\n///COMM SEAMPATH\n///ATTR SC,RW,RJ\n////FRAME ";
    text += user ? "USER " + plain(*user) : std::string("BASE");
    return {name + ".jbi", crlf(text + "\n///GROUP1 RB1\nNOP\n" + writer.instructions + "END\n")};
}

void set_up(Writer& writer, const Program& program, const ExportOptions& options) {
    std::vector<std::string> head = preamble(program, options, kRounding_mm);
    head.push_back("Units: mm, deg, V in " + options.yaskawa_speed_unit + "; Rx, Ry, Rz about X, Y, Z.");
    if (options.arm_robot == "yaskawa" && program.plan.arm) {
        head.push_back("Pulses per deg: " + list(options.yaskawa_pulses_per_deg, " ") + " .");
    }
    for (const std::string& comment : wrapped(head, kMaxComment)) {
        writer.line("'" + comment);
    }
}

// Six to twenty-four of 0 and 1.
bool is_configuration(std::string_view text) {
    const std::size_t count = (text.size() + 1) / 2;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (i % 2 == 0 ? text[i] != '0' && text[i] != '1' : text[i] != ',') {
            return false;
        }
    }
    return text.size() % 2 == 1 && count >= 6 && count <= 24;
}

Told told(const ExportOptions& options) {
    return with_arc(options) ? Told::welding : Told::motion;
}

std::vector<std::string> problems(const ExportOptions& options) {
    std::vector<std::string> found = name_problems("program_name", options.program_name, kMaxProgramName, {}, "INFORM");
    append(found, needed_number_problems("yaskawa_tool", options.yaskawa_tool, 0, 63, "number of a tool"));
    append(found, number_problems("yaskawa_user_frame", options.yaskawa_user_frame, 1, 63, "number of a user frame"));
    append(found, number_problems("yaskawa_arc_start", options.yaskawa_arc_start, 1, 64, "arc start file"));
    append(found, number_problems("yaskawa_arc_end", options.yaskawa_arc_end, 1, 64, "arc end file"));
    append(found, number_problems("yaskawa_weave", options.yaskawa_weave, 1, 255, "weaving file"));
    if (unit_of(options) == nullptr) {
        found.push_back("yaskawa_speed_unit: \"" + options.yaskawa_speed_unit +
                        "\" is no unit of V=; what your controller is set to was needed: mm/s, cm/min, m/min or "
                        "inch/min");
    }
    if (!is_configuration(options.yaskawa_configuration)) {
        found.push_back("yaskawa_configuration: \"" + options.yaskawa_configuration +
                        "\" is no RCONF; 6 to 24 of 0 and 1 were needed, as in \"1,0,0,0,0,0\"");
    }
    const auto &start = options.yaskawa_arc_start, &end = options.yaskawa_arc_end;
    if (start.has_value() != end.has_value()) {
        found.emplace_back(start ? "yaskawa_arc_end: no arc end file was given; one was needed with yaskawa_arc_start"
                                 : "yaskawa_arc_start: no arc start file was given; one was needed with "
                                   "yaskawa_arc_end");
    }
    const std::vector<double>& pulses_per_deg = options.yaskawa_pulses_per_deg;
    const auto counts = [](double n) { return std::isfinite(n) && std::abs(n) >= kLeastPulses_per_deg; };
    if ((options.arm_robot == "yaskawa" || !pulses_per_deg.empty()) &&
        !(pulses_per_deg.size() == 6 && std::all_of(pulses_per_deg.begin(), pulses_per_deg.end(), counts))) {
        found.push_back("yaskawa_pulses_per_deg: [" + list(pulses_per_deg, ", ") +
                        "] are no pulses of six axes, 500 per deg or more; those of your "
                        "arm were needed, since arm_robot is yaskawa");
    }
    if (options.yaskawa_weave && !start) {
        found.emplace_back("yaskawa_weave: stands alone; yaskawa_arc_start and yaskawa_arc_end were needed with it");
    }
    return found;
}

std::vector<TextFile> write(const Program& program, const ExportOptions& options) {
    return jobs<Writer>(program, options, {kMaxLines, "yaskawa", "CALL JOB:"}, set_up, file);
}

}  // namespace yaskawa_writer

constinit const Format kYaskawa{"yaskawa",
                                yaskawa_writer::kRounding_mm,
                                yaskawa_writer::kMaxCoordinate_mm,
                                0,
                                true,
                                true,
                                Axes::air,
                                true,
                                yaskawa_writer::told,
                                yaskawa_writer::problems,
                                yaskawa_writer::write,
                                read_yaskawa};

}  // namespace seampath::exporting
