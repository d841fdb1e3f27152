#pragma once

#include <span>
#include <utility>

#include "stages/geometry/grid.hpp"
#include "stages/plan/plan.hpp"
#include "stages/types.hpp"

/// Private to the plan stage: the torch's room in the scan.
namespace seampath::planning {

/// A torch by its dimensions, in the frame of its tool: the nozzle, a cone along -Z that begins plan.stick_out_mm
/// behind the tool centre point, and a cylinder from the middle of its base on, bent back towards -X by
/// plan.neck_angle_deg.
class TorchShape {
public:
    explicit TorchShape(const PlanOptions& options);

    /// Signed distance of a point from the torch's surface, mm; below 0 inside.
    double distance(const Eigen::Vector3d& p_in_tool) const;

    /// Largest distance of any of it from the tool centre point, or more.
    double reach_mm() const { return reach_; }

    /// Low and high corner, in another frame, of a box that holds it.
    std::pair<Eigen::Vector3d, Eigen::Vector3d> box(const Eigen::Isometry3d& frame_from_tool) const;

private:
    struct Frustum {
        Eigen::Vector3d base, axis;    // middle of one end, unit towards the other
        double length, radius, other;  // of both ends
        double distance(const Eigen::Vector3d& p) const;
    };
    Frustum nozzle_, body_;
    double reach_;
};

/// The scan's points that the torch can come near to along these seams.
class Clearance {
public:
    /// Keeps a reference to the scan's origin only. Needs options.nozzle_tip_mm.
    Clearance(const Scan& scan, std::span<const SeamModel> models, const PlanOptions& options);

    /// By how much the scan reaches into the torch with plan.torch_clearance_mm around it, mm, or 0: that of the third
    /// deepest point, for one or two are strays. Of what is deeper than `enough` only that it is.
    double depth(const Eigen::Vector3d& p, const Eigen::Quaterniond& q, double enough = 1e300) const;
    bool touches(const Eigen::Vector3d& p, const Eigen::Quaterniond& q) const { return depth(p, q, 0) > 0; }

    /// Whether the torch touches nothing on the straight way, looked at every few millimetres and degrees.
    bool way_is_free(const Waypoint& from, const Waypoint& to) const;

private:
    TorchShape torch_;
    Eigen::Vector3d origin_;
    double clearance_;
    PointGrid grid_;
};

}  // namespace seampath::planning
