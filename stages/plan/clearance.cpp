#include "stages/plan/clearance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/geometry/pose.hpp"

namespace seampath::planning {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Of the cells in which points are looked for: some hundred cells hold what is near a torch.
constexpr double kClearanceCell_mm = 3;

// One or two points in the air are strays of the scanner.
constexpr std::size_t kTouching = 3;

// Between looks on a straight way.
constexpr double kLook_mm = 5, kLookTurn = 5 * kDegree;

double distance_to_piece(const Vector2d& p, const Vector2d& a, const Vector2d& b) {
    const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
    return (p - a - t * (b - a)).norm();
}

// Which points lie in the seams' box, widened by all that a torch can reach.
std::vector<std::uint8_t> in_reach(const Scan& scan, std::span<const SeamModel> models, double reach) {
    Vector3d low = Vector3d::Constant(1e300), high = -low;
    for (const SeamModel& model : models) {
        for (const Vector3d& p : model.curve.control) {
            low = low.cwiseMin(p);
            high = high.cwiseMax(p);
        }
    }
    const Eigen::Array3f least = (low.array() - reach - scan.origin_mm.array()).cast<float>();
    const Eigen::Array3f most = (high.array() + reach - scan.origin_mm.array()).cast<float>();
    std::vector<std::uint8_t> keep;
    keep.reserve(scan.points.size());
    for (const Eigen::Vector3f& p : scan.points) {
        keep.push_back((p.array() >= least).all() && (p.array() <= most).all() ? 1 : 0);
    }
    return keep;
}

}  // namespace

TorchShape::TorchShape(const PlanOptions& o) {
    ensure(o.nozzle_tip_mm.has_value(), "a torch has a nozzle");
    const double bend = o.neck_angle_deg * kDegree;
    const Vector3d back = -Vector3d::UnitZ(), mouth = o.stick_out_mm * back;
    nozzle_ = {mouth, back, o.nozzle_length_mm, 0.5 * *o.nozzle_tip_mm, 0.5 * o.nozzle_base_mm};
    const Vector3d along(-std::sin(bend), 0, -std::cos(bend));
    body_ = {mouth + o.nozzle_length_mm * back, along, o.body_length_mm, 0.5 * o.body_diameter_mm,
             0.5 * o.body_diameter_mm};
    reach_ = o.stick_out_mm + o.nozzle_length_mm + o.body_length_mm +
             0.5 * std::max({*o.nozzle_tip_mm, o.nozzle_base_mm, o.body_diameter_mm});
}

// In the half plane of the axis, a trapezium.
double TorchShape::Frustum::distance(const Vector3d& p) const {
    const double h = (p - base).dot(axis), r = (p - base - h * axis).norm();
    const Vector2d q(r, h), a(0, 0), b(radius, 0), c(other, length), d(0, length);
    const double near = std::min({distance_to_piece(q, a, b), distance_to_piece(q, b, c), distance_to_piece(q, c, d)});
    const bool inside = h >= 0 && h <= length && r <= radius + (other - radius) * h / length;
    return inside ? -near : near;
}

double TorchShape::distance(const Vector3d& p) const {
    return std::min(nozzle_.distance(p), body_.distance(p));
}

std::pair<Vector3d, Vector3d> TorchShape::box(const Eigen::Isometry3d& frame_from_tool) const {
    Vector3d low = Vector3d::Constant(1e300), high = -low;
    for (const Frustum& f : {nozzle_, body_}) {
        for (const double at : {0.0, f.length}) {
            const Vector3d end = frame_from_tool * (f.base + at * f.axis);
            const Vector3d around = Vector3d::Constant(std::max(f.radius, f.other));
            low = low.cwiseMin(end - around);
            high = high.cwiseMax(end + around);
        }
    }
    return {low, high};
}

Clearance::Clearance(const Scan& scan, std::span<const SeamModel> models, const PlanOptions& o)
    : torch_(o),
      origin_(scan.origin_mm),
      clearance_(o.torch_clearance_mm),
      grid_(scan.points, kClearanceCell_mm,
            in_reach(scan, models, torch_.reach_mm() + std::max(o.approach_mm, o.retract_mm) + clearance_)) {}

double Clearance::depth(const Vector3d& p, const Eigen::Quaterniond& q, double enough) const {
    Eigen::Isometry3d frame_from_tool = Eigen::Isometry3d::Identity();
    frame_from_tool.linear() = q.toRotationMatrix();
    frame_from_tool.translation() = p - origin_;
    const Eigen::Isometry3d tool_from_frame = frame_from_tool.inverse();
    const double near = std::sqrt(3.0) * grid_.cell() + clearance_;
    std::array<double, kTouching> deepest{};  // descending
    const auto look = [&](std::size_t cell) {
        if (deepest.back() > enough) {
            return;
        }
        const auto points = grid_.points(cell);
        // Any of the cell's points stands for it: no other is further than the cell's diagonal.
        if (torch_.distance(tool_from_frame * points.front().cast<double>()) > near - deepest.back()) {
            return;
        }
        for (const Eigen::Vector3f& point : points) {
            double depth = clearance_ - torch_.distance(tool_from_frame * point.cast<double>());
            for (double& deep : deepest) {
                if (depth > deep) {
                    std::swap(depth, deep);
                }
            }
        }
    };
    const auto [low, high] = torch_.box(frame_from_tool);
    const Vector3d room = Vector3d::Constant(clearance_);
    grid_.for_cells_in_box(low - room, high + room, look);
    return deepest.back();
}

bool Clearance::way_is_free(const Waypoint& from, const Waypoint& to) const {
    const double looks =
        std::ceil(std::max((to.p - from.p).norm() / kLook_mm, rotation_angle(from.q, to.q) / kLookTurn));
    const Eigen::Quaterniond end = nearest_sign(to.q, from.q);
    for (double look = 0; look <= looks; ++look) {
        const double share = looks > 0 ? look / looks : 0;
        if (touches(from.p + share * (to.p - from.p), from.q.slerp(share, end))) {
            return false;
        }
    }
    return true;
}

}  // namespace seampath::planning
