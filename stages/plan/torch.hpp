#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "stages/geometry/bspline.hpp"
#include "stages/plan/plan.hpp"
#include "stages/types.hpp"

/// Private to the plan stage: where the torch is and how it stands at any place of one seam.
namespace seampath::planning {

struct TorchPose {
    double u = 0;  ///< parameter of the curve
    double station_mm = 0;
    Eigen::Vector3d p;     ///< mm
    Eigen::Quaterniond q;  ///< scan_from_tool, either sign
    double sigma_mm = 0;
};

class TorchPath {
public:
    /// Keeps a reference to the model. Throws InputError for a seam too short to plan.
    TorchPath(const SeamModel& model, int seam, const PlanOptions& options);

    const SeamModel& model() const { return model_; }
    const ArcLength& arc() const { return arc_; }
    int seam() const { return seam_; }

    /// +Z is the direction nearest to -(n1 + n2) that is square to travel, +X is along travel; then the work angle
    /// turns about +X and the travel angle about +Y. Throws InputError where the flanks have no bisector.
    TorchPose at_parameter(double u) const { return at(u, arc_.station(u)); }
    TorchPose at_station(double station_mm) const;

private:
    TorchPose at(double u, double station_mm) const;

    const SeamModel& model_;
    ArcLength arc_;
    int seam_;
    Eigen::Quaterniond tilt_;
};

}  // namespace seampath::planning
