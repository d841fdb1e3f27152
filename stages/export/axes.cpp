#include <algorithm>
#include <cmath>
#include <map>

#include "stages/error.hpp"
#include "stages/export/format.hpp"

/// What the arm of a plan does, for the languages that tell it.
namespace seampath::exporting {
namespace {

constexpr double kNanosecond = 1e-9;

// In less time an axis turns by nothing that a speed could be told from.
constexpr double kLeastTime_s = 1e-6;

// Where the torch stops: the ends of each way, and where the arc is struck and ends.
bool rests(const ArmSample& sample) {
    return sample.waypoint >= 0 && sample.kind != WaypointKind::weld && sample.kind != WaypointKind::air;
}

// The slope, in the middle one of three points, of the parabola through them.
double slope(const AxisPoint& a, const AxisPoint& b, const AxisPoint& c, std::size_t axis) {
    const double before = b.time_s - a.time_s, behind = c.time_s - b.time_s;
    const auto chord = [&](const AxisPoint& from, const AxisPoint& to, double time) {
        return time < kLeastTime_s ? 0 : (to.q[axis] - from.q[axis]) / time;
    };
    return (chord(a, b, before) * behind + chord(b, c, behind) * before) / (before + behind);
}

// Times go on by a nanosecond at least, where the torch turns on the spot.
std::vector<AxisPoint> points_of(const std::vector<ArmSample>& samples) {
    std::vector<AxisPoint> points;
    for (const ArmSample& sample : samples) {
        const double least = points.empty() ? 0 : points.back().time_s + kNanosecond;
        points.push_back({std::max(sample.time_s, least), sample.q, {}});
    }
    for (std::size_t k = 1; k + 1 < points.size(); ++k) {
        for (std::size_t axis = 0; axis < 6 && !rests(samples[k]); ++axis) {
            points[k].dq[axis] = slope(points[k - 1], points[k], points[k + 1], axis);
        }
    }
    return points;
}

bool in_air(const Target& target) {
    return target.at.kind == WaypointKind::air || target.at.kind == WaypointKind::approach;
}

void add_travel(std::vector<Target>& targets, const std::vector<ArmSample>& samples) {
    const std::vector<AxisPoint> points = points_of(samples);
    std::size_t next = 0;
    for (std::size_t k = 0; k < targets.size(); ++k) {
        Target& target = targets[k];
        for (bool there = false; !there; ++next) {
            ensure(next < points.size(), "the arm passes every waypoint");
            target.axes.push_back(points[next]);
            there = samples[next].waypoint >= 0;
        }
        ensure(samples[next - 1].waypoint == static_cast<int>(target.waypoint), "the arm passes waypoints in order");
        // A nanosecond later where the torch turns on the spot.
        target.at.time_s = target.axes.back().time_s;
        const double length = k == 0 ? 0 : (target.at.p - targets[k - 1].at.p).norm();
        if (in_air(target) && length > 0) {
            target.at.speed_mm_s = length / (target.at.time_s - targets[k - 1].at.time_s);
        }
    }
    ensure(next == points.size(), "the arm's travel ends in the last waypoint");
}

void add_air(std::vector<Target>& targets, const std::vector<ArmSample>& samples) {
    std::map<std::size_t, const ArmSample*> at;
    for (const ArmSample& sample : samples) {
        if (sample.waypoint >= 0) {
            at[static_cast<std::size_t>(sample.waypoint)] = &sample;
        }
    }
    for (std::size_t k = 0; k < targets.size(); ++k) {
        Target& target = targets[k];
        // From one approach to another the torch leads in.
        const bool leads_in =
            k > 0 && target.at.kind == WaypointKind::approach && targets[k - 1].at.kind == WaypointKind::approach;
        if (in_air(target) && !leads_in) {
            const auto found = at.find(target.waypoint);
            ensure(found != at.end(), "the arm passes every waypoint");
            target.move = Move::joint;
            target.axes = {{0, found->second->q, {}}};
        }
    }
}

}  // namespace

void add_axes(Program& program, const Format& format, const ExportOptions& options) {
    const auto& arm = program.plan.arm;
    if (!arm || arm->samples.empty()) {
        return;
    }
    if (format.axes == Axes::all) {
        add_travel(program.targets, arm->samples);
    } else if (format.axes == Axes::air && options.arm_robot == format.name) {
        add_air(program.targets, arm->samples);
    }
}

}  // namespace seampath::exporting
