#pragma once

#include <vector>

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

/// An angle along a seam: straight between ascending stations, constant beyond them, 0 when there are none.
struct AngleTable {
    std::vector<double> station_mm;
    std::vector<double> angle;  ///< rad, one a station

    double at(double station) const;
};

/// The wire's lean in the frame of the middle between the flanks, rad; see TravelSample.
struct Lean {
    double work = 0;
    double travel = 0;
};

class TorchPath {
public:
    /// Keeps references to model and options. `before_mm`: of the seam before this piece of it, by which the stations
    /// of plan.angle_table count. Throws InputError for a seam too short to plan.
    TorchPath(const SeamModel& model, int seam, const PlanOptions& options, double before_mm = 0);

    const SeamModel& model() const { return model_; }
    const ArcLength& arc() const { return arc_; }
    int seam() const { return seam_; }
    double before_mm() const { return before_mm_; }
    double first() const { return first_parameter(arc_.curve()); }
    double last() const { return last_parameter(arc_.curve()); }

    /// In the frame of middle() the work angle turns about +X, the travel angle about +Y, the roll about +Z: the
    /// constant ones or those of plan.angle_table, what plan.torch_law adds to the work angle, both smoothed where
    /// plan.tilt_rate_deg_mm says so, and the roll of plan.roll. Throws InputError where the flanks have no bisector.
    TorchPose at_parameter(double u) const { return at(u, arc_.station(u)); }
    TorchPose at_station(double station_mm) const;

    /// +Z is the direction nearest to -(n1 + n2) that is square to travel, +X is along travel. Within
    /// plan.corner_reach_mm of a corner it turns evenly from what it is on one side to what it is on the other.
    Eigen::Quaterniond middle(double u, double station_mm) const;

    /// Stations of the corners, ascending, without the ends.
    std::vector<double> corners() const;

    /// Half the angle between the flanks, in the section square to travel, rad.
    double half_opening(double u, double station_mm) const;

    /// Of a pose of this path.
    Lean lean(const TorchPose& pose) const;

    /// Leans the torch by so much more about the direction of travel and turns it about its wire.
    void hold_aside(AngleTable work, AngleTable roll);

private:
    /// A corner, and how the middle between the flanks turns in it.
    struct Turn {
        double station_mm;
        double reach_mm;
        Eigen::Quaterniond turn;
    };
    /// Where flanks and tangent are those of one side: off a corner.
    struct Beside {
        double u, station_mm;
    };

    void add_turns();
    Beside beside(double u, double station_mm) const;
    Eigen::Quaterniond middle_of_flanks(const Beside& at) const;
    TorchPose at(double u, double station_mm) const;
    Lean asked_lean(double u, double station_mm) const;
    void smooth_lean(double rate);
    void turn_least();

    const SeamModel& model_;
    const PlanOptions& options_;
    ArcLength arc_;
    int seam_;
    double before_mm_;
    std::vector<Turn> turns_;
    AngleTable smooth_work_, smooth_travel_, aside_work_, aside_roll_, least_roll_;
};

}  // namespace seampath::planning
