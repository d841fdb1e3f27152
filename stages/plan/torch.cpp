#include "stages/plan/torch.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/plan/text.hpp"
#include "stages/plan/tilt.hpp"

namespace seampath::planning {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

// |n1 + n2|, and its part square to travel, of a joint that opens by 3 degrees: below it, half a degree of error in a
// flank turns the bisector by 10.
constexpr double kMinBisector = 0.05;

// A seam must be longer than so many chord tolerances, or its shape is within the tolerance of a point.
constexpr double kMinTolerances = 10;

// Nearer to a corner, mm, rounding decides on which side of it a place is.
constexpr double kAtCorner_mm = 1e-6;

// Places at which angles along a seam are worked out.
constexpr int kTiltSteps = 2000;

Vector3d square_to(const Vector3d& x, const Vector3d& n) {
    return n - n.dot(x) * x;
}

}  // namespace

double AngleTable::at(double station) const {
    if (angle.empty()) {
        return 0;
    }
    const auto above = std::upper_bound(station_mm.begin(), station_mm.end(), station);
    if (above == station_mm.begin() || above == station_mm.end()) {
        return above == station_mm.begin() ? angle.front() : angle.back();
    }
    const auto k = static_cast<std::size_t>(above - station_mm.begin());
    const double share = (station - station_mm[k - 1]) / (station_mm[k] - station_mm[k - 1]);
    return angle[k - 1] + share * (angle[k] - angle[k - 1]);
}

TorchPath::TorchPath(const SeamModel& model, int seam, const PlanOptions& options, double before_mm)
    : model_(model), options_(options), arc_(model.curve), seam_(seam), before_mm_(before_mm) {
    const double length = arc_.length();
    if (!(length > kMinTolerances * options.chord_tolerance_mm)) {
        throw InputError(seam_text(seam) + " is " + number(length) + " mm long; it must be longer than " +
                         number(kMinTolerances * options.chord_tolerance_mm) +
                         " mm, ten times plan.chord_tolerance_mm; lower the tolerance or leave the seam out");
    }
    ensure(std::abs(length - model.length_mm) <= 1e-6 * length, "the model's length is that of its curve");
    add_turns();
    if (options.tilt_rate_deg_mm) {
        smooth_lean(*options.tilt_rate_deg_mm * kDegree);
    }
    if (options.roll == RollLaw::least) {
        turn_least();
    }
}

TorchPose TorchPath::at_station(double station_mm) const {
    // A closed curve's inversion wraps its last station to its first; the pose is the same, the parameter is not.
    const bool is_end = station_mm >= arc_.length();
    return at(is_end ? last() : arc_.parameter(station_mm), station_mm);
}

void TorchPath::add_turns() {
    const std::vector<double>& corners = model_.corners_mm;
    for (std::size_t k = 0; k < corners.size(); ++k) {
        const double at = corners[k], end = arc_.length();
        if (at < 3 * kAtCorner_mm || at > end - 3 * kAtCorner_mm) {
            continue;
        }
        const double before = k > 0 ? 0.5 * (at - corners[k - 1]) : at;
        const double behind = k + 1 < corners.size() ? 0.5 * (corners[k + 1] - at) : end - at;
        const auto side = [&](double station) { return middle_of_flanks({arc_.parameter(station), station}); };
        turns_.push_back({at, std::min({options_.corner_reach_mm, before, behind}),
                          side(at - 2 * kAtCorner_mm).conjugate() * side(at + 2 * kAtCorner_mm)});
    }
}

std::vector<double> TorchPath::corners() const {
    std::vector<double> stations;
    for (const Turn& turn : turns_) {
        stations.push_back(turn.station_mm);
    }
    return stations;
}

TorchPath::Beside TorchPath::beside(double u, double station_mm) const {
    for (const Turn& turn : turns_) {
        if (std::abs(station_mm - turn.station_mm) < kAtCorner_mm) {
            const double station = turn.station_mm - 2 * kAtCorner_mm;
            return {arc_.parameter(station), station};
        }
    }
    return {u, station_mm};
}

Eigen::Quaterniond TorchPath::middle(double u, double station_mm) const {
    const Beside at = beside(u, station_mm);
    Eigen::Quaterniond q = middle_of_flanks(at);
    for (const Turn& turn : turns_) {
        const double off = station_mm - turn.station_mm;
        if (std::abs(off) < turn.reach_mm) {
            const double t = 0.5 + 0.5 * off / turn.reach_mm, share = t * t * (3 - 2 * t);
            const auto none = Eigen::Quaterniond::Identity();
            return q * (at.station_mm < turn.station_mm ? none.slerp(share, turn.turn)
                                                        : none.slerp(1 - share, turn.turn.conjugate()));
        }
    }
    return q;
}

Eigen::Quaterniond TorchPath::middle_of_flanks(const Beside& at) const {
    const FlankSample flanks = flanks_at(model_, at.station_mm);
    const Vector3d x = tangent(arc_.curve(), at.u);
    const Vector3d across = square_to(x, flanks.n1 + flanks.n2);
    if (!(across.norm() >= kMinBisector)) {
        throw InputError(seam_text(seam_) + ": at station " + number(at.station_mm) +
                         " mm the flanks leave the torch no bisector (|n1 + n2| square to travel is " +
                         number(across.norm()) + "); at least " + number(kMinBisector) +
                         " is needed; look at the flank normals of this seam, or leave it out");
    }
    Eigen::Matrix3d scan_from_middle;
    scan_from_middle.col(0) = x;
    scan_from_middle.col(2) = -across.normalized();
    scan_from_middle.col(1) = scan_from_middle.col(2).cross(x);
    return Eigen::Quaterniond(scan_from_middle);
}

double TorchPath::half_opening(double u, double station_mm) const {
    const Beside at = beside(u, station_mm);
    const FlankSample flanks = flanks_at(model_, at.station_mm);
    const Vector3d x = tangent(arc_.curve(), at.u);
    const Vector3d a = square_to(x, flanks.n1), b = square_to(x, flanks.n2);
    return 0.5 * (0.5 * kTurn - std::atan2(a.cross(b).norm(), a.dot(b)));
}

Lean TorchPath::asked_lean(double u, double station_mm) const {
    const std::vector<double>& table = options_.angle_table;
    Lean lean{options_.work_angle_deg * kDegree, options_.travel_angle_deg * kDegree};
    if (!table.empty()) {
        AngleTable work, travel;
        for (std::size_t i = 0; i + 2 < table.size(); i += 3) {
            work.station_mm.push_back(table[i]);
            work.angle.push_back(table[i + 1] * kDegree);
            travel.angle.push_back(table[i + 2] * kDegree);
        }
        travel.station_mm = work.station_mm;
        lean = {work.at(before_mm_ + station_mm), travel.at(before_mm_ + station_mm)};
    }
    if (options_.torch_law != TorchLaw::bisector) {
        const double more = half_opening(u, station_mm) - options_.flank_angle_deg * kDegree;
        lean.work += options_.torch_law == TorchLaw::flank1 ? more : -more;
    }
    return lean;
}

TorchPose TorchPath::at(double u, double station_mm) const {
    const Lean asked = asked_lean(u, station_mm);
    const double work = asked.work + smooth_work_.at(station_mm) + aside_work_.at(station_mm);
    const double travel = asked.travel + smooth_travel_.at(station_mm);
    const double roll = options_.roll_deg * kDegree + least_roll_.at(station_mm) + aside_roll_.at(station_mm);
    TorchPose pose;
    pose.u = u;
    pose.station_mm = station_mm;
    pose.p = position(arc_.curve(), u);
    pose.q = middle(u, station_mm) * AngleAxisd(work, Vector3d::UnitX()) * AngleAxisd(travel, Vector3d::UnitY());
    if (roll != 0) {
        pose.q = pose.q * AngleAxisd(roll, Vector3d::UnitZ());
    }
    pose.q.normalize();
    pose.sigma_mm = flanks_at(model_, station_mm).sigma_mm;
    return pose;
}

Lean TorchPath::lean(const TorchPose& pose) const {
    const Vector3d z = middle(pose.u, pose.station_mm).conjugate() * (pose.q * Vector3d::UnitZ());
    return {std::atan2(-z.y(), z.z()), std::asin(std::clamp(z.x(), -1.0, 1.0))};
}

void TorchPath::smooth_lean(double rate) {
    std::vector<double> stations;
    std::vector<Place> places;
    for (int k = 0; k <= kTiltSteps; ++k) {
        stations.push_back(arc_.length() * k / kTiltSteps);
        const TorchPose pose = at_station(stations.back());
        places.push_back({pose.p, middle(pose.u, pose.station_mm) * Vector3d::UnitX(), pose.q * Vector3d::UnitZ()});
    }
    const LeanChange change = smoothed(places, stations, rate, model_.closed);
    smooth_work_ = {stations, change.work};
    smooth_travel_ = {stations, change.travel};
}

void TorchPath::turn_least() {
    std::vector<double> stations;
    std::vector<Eigen::Quaterniond> q;
    least_roll_ = {};
    for (int k = 0; k <= kTiltSteps; ++k) {
        stations.push_back(arc_.length() * k / kTiltSteps);
        q.push_back(at_station(stations.back()).q);
    }
    least_roll_ = {stations, least_turning_roll(q)};
}

void TorchPath::hold_aside(AngleTable work, AngleTable roll) {
    aside_work_ = std::move(work);
    aside_roll_ = {};
    if (options_.roll == RollLaw::least) {
        turn_least();
    }
    aside_roll_ = std::move(roll);
}

}  // namespace seampath::planning
