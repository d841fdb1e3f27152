#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

/// Private to the plan stage: how a torch leans and turns along a seam as a whole.
namespace seampath::planning {

/// The seam's point, its direction and the wire's direction (both unit) at one place.
struct Place {
    Eigen::Vector3d p, x, wire;
};

/// Unit vectors square to the seam, one a place, that turn about it as little as possible: rotation-minimising frames
/// by double reflection (Wang, Juettler, Zheng & Liu, ACM TOG 27, 2008). The first is `start` made square to the seam.
std::vector<Eigen::Vector3d> least_turning(const std::vector<Place>& places, const Eigen::Vector3d& start);

/// What to add to work and travel angle, rad, one a place.
struct LeanChange {
    std::vector<double> work, travel;
};

/// So that neither angle changes by more than `rate`, rad/mm. The work angle is that of the wire about the seam against
/// least_turning(). Of an angle a(s) that is half the sum of max over r of a(r) - rate |s - r| and min
/// over r of a(r) + rate |s - r|, the least and the largest function above and below it that change by no more than the
/// rate. It is the same from either end, and a where a has no more than the rate. Needs places at ascending stations,
/// near enough to each other that the wire's lean turns by less than half a turn from one to the next; `closed`: the
/// last is the first once more.
LeanChange smoothed(const std::vector<Place>& places, const std::vector<double>& stations, double rate, bool closed);

/// Rolls, rad, one an orientation and 0 for the first, after which the tool's Z goes from each to the next with no turn
/// about itself. Never jumps.
std::vector<double> least_turning_roll(const std::vector<Eigen::Quaterniond>& q);

}  // namespace seampath::planning
