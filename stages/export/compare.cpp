#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "stages/error.hpp"
#include "stages/export/format.hpp"
#include "stages/export/text.hpp"
#include "stages/geometry/pose.hpp"

namespace seampath::exporting {
namespace {

constexpr double kMaxSpeedError = 0.005;

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

// 0 where the file has no speed to compare: joint moves run at a share of the axes' speeds.
double speed_error(const Format& f, const Target& written, const Target& read) {
    if (!f.speeds || (written.move == Move::joint && std::isnan(read.at.speed_mm_s))) {
        return 0;
    }
    return std::abs(read.at.speed_mm_s / written.at.speed_mm_s - 1);
}

// Largest difference of an axis, deg; infinite where times or speeds differ.
double axis_error(const std::vector<AxisPoint>& written, const std::vector<AxisPoint>& read) {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    // Of times and speeds: languages that tell them have nanoseconds and more.
    constexpr double kRounding = 1e-9;
    double worst = written.size() == read.size() ? 0 : kNever;
    for (std::size_t i = 0; i < written.size() && worst < kNever; ++i) {
        const AxisPoint &a = written[i], &b = read[i];
        bool same = std::abs(a.time_s - b.time_s) <= kRounding;
        for (std::size_t axis = 0; axis < a.q.size(); ++axis) {
            same = same && std::abs(a.dq[axis] - b.dq[axis]) <= kRounding && std::isfinite(b.q[axis]);
            worst = std::max(worst, 180 / std::numbers::pi * std::abs(a.q[axis] - b.q[axis]));
        }
        worst = same ? worst : kNever;
    }
    return worst;
}

}  // namespace

ReadBack compare(const Format& f, Told told, const std::vector<Target>& written, const std::vector<Target>& read) {
    const auto fail = [&](const std::string& what) {
        throw InternalError("export: " + std::string(f.name) + ": the program does not say what was planned: " + what);
    };
    if (written.size() != read.size()) {
        fail(std::to_string(read.size()) + " moves instead of " + std::to_string(written.size()));
    }
    ReadBack worst;
    for (std::size_t k = 0; k < written.size(); ++k) {
        const Waypoint &a = written[k].at, &b = read[k].at;
        // A move along the axes tells where they end.
        const bool has_pose = f.axes != Axes::air || written[k].axes.empty();
        const double angle = has_pose ? rotation_angle(a.q, b.q) * 180 / std::numbers::pi : 0;
        const double speed = speed_error(f, written[k], read[k]);
        const double axes = axis_error(written[k].axes, read[k].axes);
        if (!(axes <= kMaxOrientationError_deg)) {
            fail("the axes are off by " + plain(axes) + " deg, or at another time, on the way to " + place(a));
        }
        // The rounding of doubles themselves is far below a nanometre.
        if (has_pose && !((a.p - b.p).array().abs() <= f.position_rounding_mm + 1e-9).all()) {
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
        if (read[k].passed && a.kind != WaypointKind::weld) {
            fail(place(a) + " is passed without a stop");
        }
        if (written[k].move != read[k].move) {
            fail(place(a) + " is reached by another kind of move");
        }
        if (told == Told::everything && !same_fields(a, b)) {
            fail(place(a) + " has another number, station, time or sigma");
        }
        worst.max_position_error_mm = std::max(worst.max_position_error_mm, has_pose ? (a.p - b.p).norm() : 0);
        worst.max_orientation_error_deg = std::max(worst.max_orientation_error_deg, angle);
        worst.max_speed_error = std::max(worst.max_speed_error, speed);
        worst.max_axis_error_deg = std::max(worst.max_axis_error_deg, axes);
    }
    return worst;
}

}  // namespace seampath::exporting
