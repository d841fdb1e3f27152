#include "pipeline/report_torch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stages/angle.hpp"
#include "stages/geometry/bspline.hpp"

namespace seampath {
namespace {

constexpr double kAnglePlotWidth = 390, kAnglePlotHeight = 220;
constexpr double kLeastAngleRange = 5;  // deg; less than what matters to a weld should look small

/// Without any lean, x is along travel and z into the joint on the flanks' bisector.
void add_angles(const SeamModel& model, const ArcLength& arc, const Waypoint& waypoint, TorchAngles& angles) {
    const FlankSample flanks = flanks_at(model, waypoint.station_mm);
    const Eigen::Vector3d x = tangent(model.curve, arc.parameter(waypoint.station_mm));
    const Eigen::Vector3d into = -(flanks.n1 + flanks.n2);
    const Eigen::Vector3d z = (into - into.dot(x) * x).normalized(), y = z.cross(x);
    const Eigen::Vector3d torch = waypoint.q * Eigen::Vector3d::UnitZ();
    const double travel = std::asin(std::clamp(torch.dot(x), -1.0, 1.0)) * kDegreesPerRadian;
    const double work = std::atan2(-torch.dot(y), torch.dot(z)) * kDegreesPerRadian;
    angles.work.push_back({waypoint.station_mm, work});
    angles.travel.push_back({waypoint.station_mm, travel});
    angles.most = std::max({angles.most, std::abs(work), std::abs(travel)});
}

}  // namespace

TorchAngles torch_angles(const PartResult& part, std::size_t seam) {
    const auto planned = std::find(part.planned_seams.begin(), part.planned_seams.end(), static_cast<int>(seam));
    const auto number = static_cast<int>(planned - part.planned_seams.begin());
    const ArcLength arc(part.models[seam].curve);
    TorchAngles angles;
    for (const Waypoint& w : part.plan.waypoints) {
        const bool begins = w.kind == WaypointKind::weld_start;
        if (planned == part.planned_seams.end() || w.seam != number ||
            (!begins && w.kind != WaypointKind::weld && w.kind != WaypointKind::weld_end)) {
            continue;
        }
        if (begins && !angles.work.empty()) {  // another pass: another line
            const PlotPoint gap{w.station_mm, std::numeric_limits<double>::quiet_NaN()};
            angles.work.push_back(gap);
            angles.travel.push_back(gap);
        }
        add_angles(part.models[seam], arc, w, angles);
    }
    return angles;
}

std::string torch_angle_plot(const PartResult& part, std::size_t seam) {
    const TorchAngles angles = torch_angles(part, seam);
    if (angles.work.empty()) {
        return "";
    }
    const double reach = 1.12 * std::max(angles.most, kLeastAngleRange);
    const PlotAxes axes{kAnglePlotWidth, kAnglePlotHeight, 0,         part.models[seam].length_mm, -reach,
                        reach,           "station, mm",    "angle, °"};
    return "<figure class=\"by-station\"><figcaption><b>Torch angles</b> <i class=\"value\"></i>work (+ leans towards "
           "flank 1) <i class=\"flank1\"></i>travel (+ push)</figcaption>" +
           svg_axes(axes, "Work and travel angle of the torch along the seam") +
           svg_line(axes, angles.travel, "flank1") + svg_line(axes, angles.work, "value") + svg_end() + "</figure>\n";
}

}  // namespace seampath
