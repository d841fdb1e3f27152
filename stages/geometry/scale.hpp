#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace seampath {

/// What the scan itself says about its resolution; every threshold of extraction and validation derives from it.
struct ScanScale {
    double spacing = 0;      ///< mm; side of the square that one point stands for on a surface
    double noise = 0;        ///< mm; robust 1-sigma of points about locally fitted quadrics
    double correlation = 1;  ///< variance of means of neighbouring points over that of as many independent ones, >= 1
};

/// The scale of a scan as a whole and place by place: a depth camera's points lie twice as far apart and are four times
/// as noisy at twice the distance, and a surface seen at a slant is sparser than one seen square.
struct ScaleField {
    ScanScale overall;                   ///< median over the places; spacing and noise 0 for fewer than 50 points
    std::vector<Eigen::Vector3d> place;  ///< mm, spread over the scan
    std::vector<ScanScale> local;        ///< of each place, smoothed over its nearest ones

    /// Of the nearest place; p in the frame of the points.
    ScanScale at(const Eigen::Vector3d& p) const;
};

/// Looks at some hundred places spread over the scan.
ScaleField estimate_scale(std::span<const Eigen::Vector3f> points);

}  // namespace seampath
