#include "stages/export/export.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "stages/error.hpp"
#include "stages/export/format.hpp"
#include "stages/export/text.hpp"
#include "stages/geometry/pose.hpp"

namespace seampath {
namespace exporting {
namespace {

constexpr double kAnywhere = std::numeric_limits<double>::infinity();
constexpr double kMaxOrientationError_deg = 0.001;
constexpr double kMaxSpeedError = 0.005;

Told tells_everything(const ExportOptions&) {
    return Told::everything;
}
std::vector<std::string> no_problems(const ExportOptions&) {
    return {};
}

// RAPID's num has 24 bits: up to 2^23 thousandths of a mm it holds every third decimal. No UR reaches 10 m; its speeds
// have a micron a second.
constexpr std::array<Format, kRobotNames.size()> kFormats{{
    {"csv", 0, kAnywhere, 0, tells_everything, no_problems, write_csv, read_csv},
    {"json", 0, kAnywhere, 0, tells_everything, no_problems, write_json, read_json},
    {"abb", kAbbRounding_mm, 8388.607, 0, abb_told, abb_problems, write_abb, read_abb},
    {"ur", kUrRounding_mm, 10000, 0.1, ur_told, ur_problems, write_ur, read_ur},
}};
static_assert([] {
    for (std::size_t i = 0; i < kFormats.size(); ++i) {
        if (kFormats[i].name != kRobotNames[i]) {
            return false;
        }
    }
    return true;
}());

std::string trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(' '), last = text.find_last_not_of(' ');
    return first == std::string_view::npos ? std::string() : std::string(text.substr(first, last - first + 1));
}

struct Robots {
    std::vector<const Format*> formats;
    std::vector<std::string> problems;
};

Robots robots_of(const ExportOptions& options) {
    std::string known;
    for (const Format& f : kFormats) {
        known += (known.empty() ? "" : ", ") + std::string(f.name);
    }
    Robots result;
    std::string_view left = options.robots;
    for (bool more = true; more;) {
        const auto comma = left.find(',');
        const std::string wanted = trimmed(left.substr(0, comma));
        more = comma != std::string_view::npos;
        left.remove_prefix(more ? comma + 1 : left.size());
        const auto found =
            std::find_if(kFormats.begin(), kFormats.end(), [&](const Format& f) { return f.name == wanted; });
        if (found == kFormats.end()) {
            result.problems.push_back("robots: \"" + wanted + "\" is no known robot; one of " + known + " was needed");
        } else if (std::find(result.formats.begin(), result.formats.end(), &*found) != result.formats.end()) {
            result.problems.push_back("robots: \"" + wanted + "\" stands twice; each robot was needed once");
        } else {
            result.formats.push_back(&*found);
        }
    }
    return result;
}

std::vector<std::string> frame_problems(const std::vector<double>& base_from_scan) {
    const bool numbers = base_from_scan.size() == 7 && std::all_of(base_from_scan.begin(), base_from_scan.end(),
                                                                   [](double v) { return std::isfinite(v); });
    double norm = 0;
    for (std::size_t i = 3; i < base_from_scan.size(); ++i) {
        norm = std::hypot(norm, base_from_scan[i]);
    }
    if (numbers && std::abs(norm - 1) <= 1e-6) {
        return {};
    }
    return {"base_from_scan: [" + list(base_from_scan, ", ") +
            "] is no pose; x, y, z in mm and a quaternion qw, qx, qy, qz of length 1 were needed"};
}

Plan in_base(const Plan& plan, const std::vector<double>& b) {
    const Eigen::Vector3d origin(b[0], b[1], b[2]);
    const Eigen::Quaterniond turn = Eigen::Quaterniond(b[3], b[4], b[5], b[6]).normalized();
    // An identity changes no bit: what is written is what was planned.
    const bool turned = turn.coeffs() != Eigen::Quaterniond::Identity().coeffs();
    Plan result = plan;
    for (Waypoint& w : result.waypoints) {
        w.p = (turned ? turn * w.p : w.p) + origin;
        w.q = turned ? (turn * w.q).normalized() : w.q;
        ensure(w.p.allFinite() && w.q.coeffs().allFinite() && std::isfinite(w.speed_mm_s) && w.speed_mm_s > 0 &&
                   std::abs(w.q.norm() - 1) < 1e-9,
               "waypoints have finite positions, unit quaternions and a speed");
    }
    return result;
}

std::string place(const Waypoint& w) {
    return "waypoint " + std::to_string(w.index) + " of seam " + std::to_string(w.seam);
}

// Refuses what the format can't hold.
void check_range(const Format& f, const std::vector<Waypoint>& waypoints) {
    for (const Waypoint& w : waypoints) {
        if (w.p.cwiseAbs().maxCoeff() > f.max_coordinate_mm) {
            throw InputError("export: " + std::string(f.name) + ": " + place(w) + " lies at " +
                             list({w.p.x(), w.p.y(), w.p.z()}, ", ") + " mm; coordinates within " +
                             plain(f.max_coordinate_mm) + " mm are needed; look at export.base_from_scan");
        }
        if (w.speed_mm_s < f.min_speed_mm_s) {
            throw InputError("export: " + std::string(f.name) + ": " + place(w) + " has a speed of " +
                             plain(w.speed_mm_s) + " mm/s; at least " + plain(f.min_speed_mm_s) +
                             " mm/s is needed for the written speed to be right; raise plan.speed_mm_s");
        }
    }
}

void append(std::vector<std::string>& to, const std::vector<std::string>& more) {
    to.insert(to.end(), more.begin(), more.end());
}

bool is_weld(WaypointKind kind) {
    return kind == WaypointKind::weld_start || kind == WaypointKind::weld || kind == WaypointKind::weld_end;
}

// The kind that a reader of such a format must find.
WaypointKind told_kind(Told told, WaypointKind kind) {
    return told == Told::everything || (told == Told::welding && is_weld(kind)) ? kind : WaypointKind::air;
}

bool same_fields(const Waypoint& a, const Waypoint& b) {
    return a.seam == b.seam && a.index == b.index && a.station_mm == b.station_mm && a.time_s == b.time_s &&
           a.sigma_mm == b.sigma_mm;
}

}  // namespace

const Format& format(std::size_t robot) {
    return kFormats.at(robot);
}

ReadBack compare(const Format& f, Told told, const std::vector<Waypoint>& plan, const std::vector<Waypoint>& read) {
    const auto fail = [&](const std::string& what) {
        throw InternalError("export: " + std::string(f.name) + ": the program does not say what was planned: " + what);
    };
    if (plan.size() != read.size()) {
        fail(std::to_string(read.size()) + " moves instead of " + std::to_string(plan.size()));
    }
    ReadBack worst;
    for (std::size_t k = 0; k < plan.size(); ++k) {
        const Waypoint &a = plan[k], &b = read[k];
        const double angle = rotation_angle(a.q, b.q) * 180 / std::numbers::pi;
        const double speed = std::abs(b.speed_mm_s / a.speed_mm_s - 1);
        // The rounding of doubles themselves is far below a nanometre.
        if (!((a.p - b.p).array().abs() <= f.position_rounding_mm + 1e-9).all()) {
            fail(place(a) + " is off by " + plain((a.p - b.p).norm()) + " mm");
        }
        if (!(angle <= kMaxOrientationError_deg)) {
            fail(place(a) + " is turned by " + plain(angle) + " deg");
        }
        if (!(speed <= kMaxSpeedError)) {
            fail(place(a) + " has a speed of " + plain(b.speed_mm_s) + " mm/s");
        }
        if (b.kind != told_kind(told, a.kind)) {
            fail(place(a) + " is " + std::string(name(b.kind)));
        }
        if (told == Told::everything && !same_fields(a, b)) {
            fail(place(a) + " has another number, station, time or sigma");
        }
        worst.max_position_error_mm = std::max(worst.max_position_error_mm, (a.p - b.p).norm());
        worst.max_orientation_error_deg = std::max(worst.max_orientation_error_deg, angle);
        worst.max_speed_error = std::max(worst.max_speed_error, speed);
    }
    return worst;
}

}  // namespace exporting

using namespace exporting;

Fields describe(ExportOptions& o) {
    return {
        {"robots", &o.robots, "robots to write programs for, comma-separated: csv, json, abb, ur"},
        {"program_name", &o.program_name, "name of the program on the controller; a letter, then letters, digits, _"},
        {"even_if_out_of_tolerance", &o.even_if_out_of_tolerance,
         "write programs for seams that failed validation too"},
        {"abb_tool", &o.abb_tool, "ABB: name of the tooldata on the controller"},
        {"abb_work_object", &o.abb_work_object, "ABB: name of the wobjdata that positions are in"},
        {"abb_seam_data", &o.abb_seam_data, "ABB: name of the seamdata for ArcL; empty, with abb_weld_data: MoveL"},
        {"abb_weld_data", &o.abb_weld_data, "ABB: name of the welddata for ArcL; empty, with abb_seam_data: MoveL"},
        {"abb_zone", &o.abb_zone, "ABB: name of the zonedata at weld points"},
        {"ur_tcp", &o.ur_tcp, "UR: tool centre point in the flange: x, y, z mm, rotation vector rad", {}, 6},
        {"ur_arc_output", &o.ur_arc_output, "UR: standard digital output that strikes the arc; none: motion only",
         within(0, 7)},
        {"base_from_scan",
         &o.base_from_scan,
         "pose of the scan frame in the base frame: x, y, z mm, qw, qx, qy, qz",
         {},
         7},
    };
}

std::vector<std::string> export_problems(const ExportOptions& options) {
    Robots robots = robots_of(options);
    std::vector<std::string> problems = std::move(robots.problems);
    for (const Format* f : robots.formats) {
        for (const std::string& problem : f->problems(options)) {
            problems.push_back(problem);
        }
    }
    append(problems, frame_problems(options.base_from_scan));
    return problems;
}

std::vector<ProgramFile> export_programs(const Plan& plan, const ExportOptions& options) {
    if (const auto problems = export_problems(options); !problems.empty()) {
        std::string message = "export: ";
        for (const std::string& problem : problems) {
            message += (&problem == &problems.front() ? "" : "\nexport: ") + problem;
        }
        throw InputError(message + "; change the options of export");
    }
    if (plan.waypoints.empty()) {
        throw InputError("export: the plan has 0 waypoints; at least one seam was needed; look at the seams' verdicts");
    }
    const Plan moved = in_base(plan, options.base_from_scan);
    std::vector<ProgramFile> programs;
    for (const Format* f : robots_of(options).formats) {
        check_range(*f, moved.waypoints);
        const std::vector<TextFile> files = f->write(moved, options);
        const ReadBack found = compare(*f, f->told(options), moved.waypoints, f->read(files));
        for (const TextFile& file : files) {
            programs.push_back({std::string(f->name), file.name, file.text, f->position_rounding_mm,
                                found.max_position_error_mm, found.max_orientation_error_deg, found.max_speed_error});
        }
    }
    return programs;
}

}  // namespace seampath
