#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/export/parts.hpp"
#include "stages/export/text.hpp"
#include "stages/geometry/arc.hpp"
#include "stages/geometry/pose.hpp"

/// FANUC TP as ASCII (.ls), for the ASCII upload. Positions in mm and angles W, P, R of Rz(R) Ry(P) Rx(W) in deg, both
/// with 3 decimals; of the roundings of an orientation the one that is nearest to it. Speeds are whole numbers: of
/// mm/sec, cm/min or, where both are off by more than 0.45 %, of msec for the move. Arc and weave by schedule numbers.
/// Through the air axis angles where the arm is known.
/// Above 9999 lines a main program and parts of whole welds.
namespace seampath::exporting {
namespace fanuc_writer {

constexpr std::size_t kMaxLines = 9999;
constexpr std::size_t kMaxProgramName = 32;  // of 36: leaves room for "_123"
constexpr std::size_t kMaxRemark = 32;
constexpr double kRounding_mm = 0.0005;
constexpr double kMaxCoordinate_mm = 8388.607;  // positions are 24-bit floats: up to 2^23 thousandths

constexpr double kMaxSpeedRounding = 0.0045;
constexpr double kMaxSpeed_mm_s = 2000;
// A time is as good as the length that it is for: of a millimetre or more, three decimals tell it to 0.2 %.
constexpr double kMaxTimeRounding = 0.003;
constexpr double kMinTimedLength_mm = 1;

bool with_arc(const ExportOptions& options) {
    return options.fanuc_arc_start.has_value();
}

// W, P, R in thousandths of a degree. Near P = 90 deg, W and R turn about the same axis and their roundings add up:
// of those around each number the ones that together are nearest.
Eigen::Vector3d rounded_angles(const Eigen::Quaterniond& q) {
    const Eigen::Vector3d zyx = kDegreesPerRadian * euler_zyx(q);
    Eigen::Vector3d best = zyx;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 27; ++i) {
        const Eigen::Array3i step(i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1);
        Eigen::Vector3d tried = (1000 * zyx).array().round() + step.cast<double>();
        tried /= 1000;
        tried = (tried.array() <= -180).select(tried.array() + 360, tried.array());
        if (tried.maxCoeff() > 180) {
            continue;
        }
        const Eigen::Vector3d rad = tried / kDegreesPerRadian;
        const double off = rotation_angle(q, from_euler_zyx(rad[0], rad[1], rad[2]));
        if (off < least - 1e-12) {
            least = off;
            best = tried;
        }
    }
    return best;
}

std::string padded(double value, std::size_t width) {
    const std::string text = fixed(value, 3);
    return std::string(width - std::min(width, text.size()), ' ') + text;
}

// Of the move to k; none behind a move along the axes, since the file does not tell where it ends.
double length_of(const std::vector<Target>& all, std::size_t k) {
    if (!all[k - 1].axes.empty()) {
        return 0;
    }
    if (all[k].move != Move::circular) {
        return (all[k].at.p - all[k - 1].at.p).norm();
    }
    const auto arc = arc_through(all[k - 2].at.p, all[k - 1].at.p, all[k].at.p);
    ensure(arc.has_value(), "circular moves go through three points of a circle");
    return arc->radius * arc->angle;
}

std::string speed(const std::vector<Target>& all, std::size_t k) {
    struct Unit {
        std::string_view name;
        double per_mm_s, low, high, worst;
    };
    const double mm_s = all[k].at.speed_mm_s, length = length_of(all, k);
    const std::array<Unit, 2> units{
        {{"mm/sec", 1, 1, kMaxSpeed_mm_s, kMaxSpeedRounding}, {"cm/min", 6, 1, 12000, kMaxSpeedRounding}}};
    std::string best;
    double least = std::numeric_limits<double>::infinity();
    for (const Unit& unit : units) {
        const double written = std::round(mm_s * unit.per_mm_s), off = std::abs(written / (mm_s * unit.per_mm_s) - 1);
        if (written >= unit.low && written <= unit.high && off <= unit.worst && off < least) {
            least = off;
            best = plain(written) + std::string(unit.name);
        }
    }
    if (!best.empty()) {
        return best;
    }
    const double exact = 1000 * length / mm_s, msec = std::round(exact);
    if (mm_s <= kMaxSpeed_mm_s && length >= kMinTimedLength_mm && msec >= 1 && msec <= 32000 &&
        std::abs(msec / exact - 1) <= kMaxTimeRounding) {
        return plain(msec) + "msec";
    }
    throw InputError(
        "export: fanuc: " + place(all[k].at) + " has a speed of " + plain(mm_s) +
        " mm/s; whole mm/sec up to 2000, cm/min or msec are needed, and none is within 0.5 % of it; change "
        "plan.speed_mm_s or plan.air_speed_mm_s");
}

// Axes as the teach pendant shows them, deg: its J3 is the forearm's angle to the floor, which J2 does not change.
std::array<double, 6> pendant_axes(const AxisPoint& axes) {
    std::array<double, 6> j = axes.q;
    j[2] -= j[1];
    return j;
}

// The wrist of a configuration is F where J5 is above 0. Turns are none of a straight move's business, and elbow and
// front are the cell's to tell.
void require_configuration(const Target& target, const ExportOptions& options) {
    const char wrist = target.axes.back().q[4] > 0 ? 'F' : 'N';
    if (options.fanuc_configuration.front() != wrist) {
        throw InputError("export: fanuc: the plan's arm comes to " + place(target.at) + " with wrist " + wrist +
                         "; a configuration with that was needed; change export.fanuc_configuration, which is \"" +
                         options.fanuc_configuration + "\", or export.base_from_scan");
    }
}

// Instructions and positions of one part.
class Writer {
public:
    Writer(const std::vector<Target>& targets, const ExportOptions& options) : all_(targets), options_(options) {}

    void line(const std::string& instruction) {
        ++lines;
        std::string number = std::to_string(lines);
        number.insert(0, 4 - std::min<std::size_t>(4, number.size()), ' ');
        instructions += number + ":" + instruction + " ;\n";
    }

    void write(const Section& part) {
        for (std::size_t k = part.begin; k < part.end; ++k) {
            position(all_[k]);
            if (all_[k].move != Move::via) {
                move(k);
            }
        }
    }
    std::string instructions, positions;
    std::size_t lines = 0;

private:
    void position(const Target& target) {
        ++points_;
        positions += "P[" + std::to_string(points_) + "]{\n   GP1:\n\tUF : " + plain(*options_.fanuc_user_frame) +
                     ", UT : " + plain(*options_.fanuc_tool) + ",\t" +
                     (target.axes.empty() ? pose(target.at) : axes(target)) + "\n};\n";
    }

    static std::string deg(const std::string& name, double value) { return name + padded(value, 9) + " deg"; }

    std::string axes(const Target& target) const {
        require_configuration(target, options_);
        const std::array<double, 6> j = pendant_axes(target.axes.back());
        std::string text;
        for (std::size_t i = 0; i < j.size(); ++i) {
            text += (i == 0   ? "\n\t"
                     : i == 3 ? ",\n\t"
                              : ",\t") +
                    deg("J" + std::to_string(i + 1) + "= ", kDegreesPerRadian * j[i]);
        }
        return text;
    }

    std::string pose(const Waypoint& w) const {
        const Eigen::Vector3d rpw = rounded_angles(w.q);
        const auto mm = [](const char* name, double value) { return name + padded(value, 9) + "  mm"; };
        return "\tCONFIG : '" + options_.fanuc_configuration + "',\n\t" + mm("X = ", w.p.x()) + ",\t" +
               mm("Y = ", w.p.y()) + ",\t" + mm("Z = ", w.p.z()) + ",\n\t" + deg("W = ", rpw[2]) + ",\t" +
               deg("P = ", rpw[1]) + ",\t" + deg("R = ", rpw[0]);
    }

    void move(std::size_t k) {
        const Target& target = all_[k];
        const WaypointKind kind = target.at.kind;
        const std::string point = "P[" + std::to_string(points_) + "] ";
        std::string text;
        if (target.move == Move::joint) {
            text = "J " + point + plain(options_.joint_speed_percent) + "% FINE   ";
        } else {
            text = target.move == Move::circular ? "C P[" + std::to_string(points_ - 1) + "]    \n    :  " : "L ";
            text += point + speed(all_, k) + (kind == WaypointKind::weld ? " CNT100   " : " FINE   ");
        }
        const bool start = kind == WaypointKind::weld_start, end = kind == WaypointKind::weld_end;
        if (with_arc(options_) && (start || end)) {
            text.erase(text.find_last_not_of(' ') + 1);
            text += "\n    :  " +
                    (start ? "Arc Start[" + plain(*options_.fanuc_arc_start)
                           : "Arc End[" + plain(*options_.fanuc_arc_end)) +
                    "]   ";
        }
        line(text);
        if (options_.fanuc_weave && (start || end)) {
            line(start ? "  Weave Sine[" + plain(*options_.fanuc_weave) + "]" : "  Weave End");
        }
    }

    const std::vector<Target>& all_;
    const ExportOptions& options_;
    std::size_t points_ = 0;
};

TextFile file(const std::string& name, const Writer& writer, const ExportOptions& options) {
    std::string text =
        "/PROG  " + name + "\n/ATTR\nOWNER\t\t= MNEDITOR;\nCOMMENT\t\t= \"Seampath\";\nPROG_SIZE\t= 0;\n";
    text += "CREATE\t\t= DATE 70-01-01  TIME 00:00:00;\nMODIFIED\t= DATE 70-01-01  TIME 00:00:00;\n";
    text += "FILE_NAME\t= ;\nVERSION\t\t= 0;\nLINE_COUNT\t= " + std::to_string(writer.lines) + ";\nMEMORY_SIZE\t= 0;\n";
    text += "PROTECT\t\t= READ_WRITE;\nTCD:  STACK_SIZE\t= 0,\n      TASK_PRIORITY\t= 50,\n      TIME_SLICE\t= 0,\n";
    text += "      BUSY_LAMP_OFF\t= 0,\n      ABORT_REQUEST\t= 0,\n      PAUSE_REQUEST\t= 0;\n";
    text += "DEFAULT_GROUP\t= 1,*,*,*,*;\nCONTROL_CODE\t= 00000000 00000000;\n";
    text += with_arc(options) ? "/APPL\n  ARC Welding Equipment : 1,*,*,*,*;\n" : "";
    return {name + ".ls", crlf(text + "/MN\n" + writer.instructions + "/POS\n" + writer.positions + "/END\n")};
}

void set_up(Writer& writer, const Program& program, const ExportOptions& options) {
    std::vector<std::string> head = preamble(program, options, kRounding_mm);
    head.emplace_back("Units: mm, deg; W, P, R about X, Y, Z.");
    for (std::string& remark : wrapped(head, kMaxRemark)) {
        std::replace(remark.begin(), remark.end(), ';', ',');  // it would end the line
        writer.line("  !" + remark);
    }
    writer.line("  UFRAME_NUM=" + plain(*options.fanuc_user_frame));
    writer.line("  UTOOL_NUM=" + plain(*options.fanuc_tool));
}

// "N U T, 0, 0, 0": wrist flip or not, elbow up or down, front or back, turns of axes 1, 4, 6.
bool is_configuration(const std::string& text) {
    const auto one_of = [&](std::size_t at, std::string_view letters) {
        return at < text.size() && letters.find(text[at]) != std::string_view::npos;
    };
    if (!(one_of(0, "NF") && one_of(1, " ") && one_of(2, "UD") && one_of(3, " ") && one_of(4, "TB"))) {
        return false;
    }
    std::string_view left = std::string_view(text).substr(5);
    for (int turn = 0; turn < 3; ++turn) {
        const std::size_t sign = left.starts_with(", -") ? 1 : 0;
        if (!left.starts_with(", ") || left.size() < 3 + sign || left[2 + sign] < '0' || left[2 + sign] > '9') {
            return false;
        }
        left.remove_prefix(3 + sign);
    }
    return left.empty();
}

Told told(const ExportOptions& options) {
    return with_arc(options) ? Told::welding : Told::motion;
}

std::vector<std::string> problems(const ExportOptions& options) {
    std::vector<std::string> found =
        name_problems("program_name", options.program_name, kMaxProgramName, {}, "FANUC TP");
    append(found, needed_number_problems("fanuc_tool", options.fanuc_tool, 1, 29, "number of a tool frame"));
    append(found,
           needed_number_problems("fanuc_user_frame", options.fanuc_user_frame, 0, 61, "number of a user frame"));
    append(found,
           number_problems("joint_speed_percent", options.joint_speed_percent, 1, 100, "share in whole percent"));
    append(found, number_problems("fanuc_arc_start", options.fanuc_arc_start, 1, 99, "weld schedule"));
    append(found, number_problems("fanuc_arc_end", options.fanuc_arc_end, 1, 99, "weld schedule"));
    append(found, number_problems("fanuc_weave", options.fanuc_weave, 1, 99, "weave schedule"));
    if (!is_configuration(options.fanuc_configuration)) {
        found.push_back("fanuc_configuration: \"" + options.fanuc_configuration +
                        "\" is no configuration; wrist N or F, elbow U or D, T or B and three turns were needed, as in "
                        "\"N U T, 0, 0, 0\"");
    }
    const auto &start = options.fanuc_arc_start, &end = options.fanuc_arc_end;
    if (start.has_value() != end.has_value()) {
        found.emplace_back(start ? "fanuc_arc_end: no weld schedule was given; one was needed with fanuc_arc_start"
                                 : "fanuc_arc_start: no weld schedule was given; one was needed with fanuc_arc_end");
    }
    if (options.fanuc_weave && !start) {
        found.emplace_back("fanuc_weave: stands alone; fanuc_arc_start and fanuc_arc_end were needed with it");
    }
    return found;
}

std::vector<TextFile> write(const Program& program, const ExportOptions& options) {
    return jobs<Writer>(program, options, {kMaxLines, "fanuc", "  CALL "}, set_up, file);
}

}  // namespace fanuc_writer

constinit const Format kFanuc{"fanuc",
                              fanuc_writer::kRounding_mm,
                              fanuc_writer::kMaxCoordinate_mm,
                              0,
                              true,
                              true,
                              Axes::air,
                              true,
                              fanuc_writer::told,
                              fanuc_writer::problems,
                              fanuc_writer::write,
                              read_fanuc};

}  // namespace seampath::exporting
