#pragma once

#include <span>

#include <Eigen/Core>

namespace seampath {

/// What the scan itself says about its resolution; every threshold of extraction and validation derives from it.
struct ScanScale {
    double spacing = 0;      ///< mm; side of the square that one point stands for on a surface
    double noise = 0;        ///< mm; robust 1-sigma of points about locally fitted quadrics
    double correlation = 1;  ///< variance of means of neighbouring points over that of as many independent ones, >= 1
};

/// Median over some hundred places spread over the scan. Fewer than 50 points: both are 0.
ScanScale estimate_scale(std::span<const Eigen::Vector3f> points);

}  // namespace seampath
