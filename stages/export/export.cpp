#include "stages/export/export.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "stages/error.hpp"
#include "stages/export/format.hpp"
#include "stages/export/text.hpp"

namespace seampath {
namespace exporting {
namespace {

constexpr std::array<const Format*, kRobotNames.size()> kFormats{&kCsv, &kJson,    &kAbb,      &kKuka, &kFanuc,
                                                                 &kUr,  &kYaskawa, &kLinuxcnc, &kRos,  &kNoether};

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
    for (const std::string_view name : kRobotNames) {
        known += (known.empty() ? "" : ", ") + std::string(name);
    }
    Robots result;
    std::string_view left = options.robots;
    for (bool more = true; more;) {
        const auto comma = left.find(',');
        const std::string wanted = trimmed(left.substr(0, comma));
        more = comma != std::string_view::npos;
        left.remove_prefix(more ? comma + 1 : left.size());
        const auto found =
            std::find_if(kFormats.begin(), kFormats.end(), [&](const Format* f) { return f->name == wanted; });
        if (found == kFormats.end()) {
            result.problems.push_back("robots: \"" + wanted + "\" is no known robot; one of " + known + " was needed");
        } else if (std::find(result.formats.begin(), result.formats.end(), *found) != result.formats.end()) {
            result.problems.push_back("robots: \"" + wanted + "\" stands twice; each robot was needed once");
        } else {
            result.formats.push_back(*found);
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

// Those whose languages have moves to angles of axes.
std::vector<std::string> arm_problems(const std::string& robot) {
    std::string known;
    for (const Format* f : kFormats) {
        if (f->axes == Axes::air) {
            known += (known.empty() ? "" : ", ") + std::string(f->name);
            if (robot == f->name) {
                return {};
            }
        }
    }
    if (robot.empty()) {
        return {};
    }
    return {"arm_robot: \"" + robot + "\" has no moves along axes; one of " + known + " was needed, or nothing"};
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

}  // namespace

const Format& format(std::size_t robot) {
    return *kFormats.at(robot);
}

Told tells_everything(const ExportOptions&) {
    return Told::everything;
}

std::vector<std::string> no_problems(const ExportOptions&) {
    return {};
}

}  // namespace exporting

using namespace exporting;

std::vector<std::string> export_problems(const ExportOptions& options) {
    Robots robots = robots_of(options);
    std::vector<std::string> problems = std::move(robots.problems);
    for (const Format* f : robots.formats) {
        append(problems, f->problems(options));
    }
    append(problems, frame_problems(options.base_from_scan));
    append(problems, arm_problems(options.arm_robot));
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
        const Program program = program_of(moved, *f, options);
        const std::vector<TextFile> files = f->write(program, options);
        const std::vector<Target> read = f->read(files);
        const ReadBack found = compare(*f, f->told(options), program.targets, read);
        const PathCheck path = check_path(program, *f, read, options);
        for (const TextFile& file : files) {
            programs.push_back({std::string(f->name), file.name, file.text, f->position_rounding_mm,
                                found.max_position_error_mm, found.max_orientation_error_deg, found.max_speed_error,
                                found.max_axis_error_deg, path.max_error_mm, path.max_turn_deg,
                                program.targets.size()});
        }
    }
    return programs;
}

}  // namespace seampath
