#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "stages/calibrate/surfels.hpp"

/// What of a surface can be seen from where, and what a scan sees past.
namespace seampath::calibrating {

/// Finds from which directions each surfel is seen past the rest of its surface, and drops those that are seen from
/// none: the surface's points as dots, looked at along each direction, the nearest of each pixel hiding those behind
/// it. Walls thinner than the distance of the points, mm, hide nothing.
void find_sights(std::vector<Surfel>& surfels, const SidedCloud& points, double point_spacing);

/// The directions, of kSights, under which a sensor may see the places of `box`; all without one.
Sights sights_from(const std::optional<Eigen::Vector3d>& sensor, const Eigen::AlignedBox3d& box);

/// What a scan shows, as its sensor saw it: how far away, by direction.
class DepthMap {
public:
    /// `scan` with its sensor; `point_spacing`: distance of its points, mm.
    DepthMap(const SidedCloud& scan, double point_spacing);

    /// Whether the scan sees past p (frame of the scan): all that it shows about that direction is more than
    /// `tolerance` mm further away. False where it shows nothing.
    bool sees_past(const Eigen::Vector3d& p, double tolerance) const;

private:
    std::optional<Eigen::Array2i> pixel_of(const Eigen::Vector3d& ray) const;
    std::size_t index_of(const Eigen::Array2i& pixel) const;  ///< from the lowest one, into nearest_

    Eigen::Vector3d sensor_;
    Eigen::Matrix3d axes_;  ///< columns; the last looks ahead
    double pixel_ = 1;      ///< of the plane at unit distance ahead
    Eigen::Array2i low_{0, 0}, size_{0, 0};
    std::vector<float> nearest_;  ///< mm from the sensor; infinite where nothing is seen
};

}  // namespace seampath::calibrating
