#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "stages/extract/track.hpp"

namespace seampath::detail {

/// The points of one flank along a seam.
struct Pool {
    std::vector<Eigen::Vector3d> points;
    std::vector<std::uint32_t> place;              ///< of each point, ascending
    std::vector<std::uint32_t> station_block;      ///< of each point: a stretch of the seam as long as a window
    std::vector<std::uint32_t> block;              ///< of each point: the same, cut into three across the flank
    std::vector<std::uint32_t> view;               ///< of each point
    std::vector<double> u;                         ///< distance of each point from the seam, mm
    std::vector<Eigen::Vector3d> places, normals;  ///< of the measured places
    std::size_t reach = 1;                         ///< places to each side that share a window
    double correlation = 1;  ///< variance of means over that of as many independent points, of those taken
    double scale = 0;        ///< robust 1-sigma of the points about the windows' own surfaces, mm
};

/// The points that the windows of flank k (0 or 1) took, place by place, thinned evenly where there are many.
Pool pool_of(const Tracker& tracker, const std::vector<TrackPoint>& way, int k);

}  // namespace seampath::detail
