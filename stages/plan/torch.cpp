#include "stages/plan/torch.hpp"

#include <cmath>
#include <string>

#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/plan/text.hpp"

namespace seampath::planning {
namespace {

// |n1 + n2|, and its part square to travel, of a joint that opens by 3 degrees: below it, half a degree of error in a
// flank turns the bisector by 10.
constexpr double kMinBisector = 0.05;

// A seam must be longer than so many chord tolerances, or its shape is within the tolerance of a point.
constexpr double kMinTolerances = 10;

}  // namespace

TorchPath::TorchPath(const SeamModel& model, int seam, const PlanOptions& options)
    : model_(model),
      arc_(model.curve),
      seam_(seam),
      tilt_(Eigen::AngleAxisd(options.work_angle_deg * kDegree, Eigen::Vector3d::UnitX()) *
            Eigen::AngleAxisd(options.travel_angle_deg * kDegree, Eigen::Vector3d::UnitY())) {
    const double length = arc_.length();
    if (!(length > kMinTolerances * options.chord_tolerance_mm)) {
        throw InputError(seam_text(seam) + " is " + number(length) + " mm long; it must be longer than " +
                         number(kMinTolerances * options.chord_tolerance_mm) +
                         " mm, ten times plan.chord_tolerance_mm; lower the tolerance or leave the seam out");
    }
    ensure(std::abs(length - model.length_mm) <= 1e-6 * length, "the model's length is that of its curve");
}

TorchPose TorchPath::at_station(double station_mm) const {
    // A closed curve's inversion wraps its last station to its first; the pose is the same, the parameter is not.
    const bool last = station_mm >= arc_.length();
    return at(last ? last_parameter(arc_.curve()) : arc_.parameter(station_mm), station_mm);
}

TorchPose TorchPath::at(double u, double station_mm) const {
    const FlankSample flanks = flanks_at(model_, station_mm);
    const Eigen::Vector3d x = tangent(arc_.curve(), u);
    const Eigen::Vector3d bisector = flanks.n1 + flanks.n2;
    const Eigen::Vector3d across = bisector - bisector.dot(x) * x;
    if (!(across.norm() >= kMinBisector)) {
        throw InputError(seam_text(seam_) + ": at station " + number(station_mm) +
                         " mm the flanks leave the torch no bisector (|n1 + n2| square to travel is " +
                         number(across.norm()) + "); at least " + number(kMinBisector) +
                         " is needed; look at the flank normals of this seam, or leave it out");
    }
    Eigen::Matrix3d scan_from_tool;
    scan_from_tool.col(0) = x;
    scan_from_tool.col(2) = -across.normalized();
    scan_from_tool.col(1) = scan_from_tool.col(2).cross(x);
    TorchPose pose;
    pose.u = u;
    pose.station_mm = station_mm;
    pose.p = position(arc_.curve(), u);
    pose.q = (Eigen::Quaterniond(scan_from_tool) * tilt_).normalized();
    pose.sigma_mm = flanks.sigma_mm;
    return pose;
}

}  // namespace seampath::planning
