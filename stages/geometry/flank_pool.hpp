#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "stages/geometry/slab.hpp"

namespace seampath {

/// One flank at one place of a seam, as the window about that place tells it.
struct FlankPlace {
    Eigen::Vector3d p;                ///< of the seam, mm
    Eigen::Vector3d normal;           ///< unit, of the flank there
    double sigma = 0;                 ///< mm, of p across the flank
    double scale = 0;                 ///< mm, robust 1-sigma of the window's points about its surface
    bool measured = true;             ///< false: no window of its own; the numbers above are a model's
    std::span<const SlabPoint> slab;  ///< the flank's points that are nearer to this place than to another
};

/// The points of one flank along a seam.
struct FlankPool {
    std::vector<Eigen::Vector3d> points;
    std::vector<std::uint32_t> place;              ///< of each point, ascending
    std::vector<std::uint32_t> station_block;      ///< of each point: a stretch of the seam as long as a window
    std::vector<std::uint32_t> block;              ///< of each point: the same, cut into three across the flank
    std::vector<std::uint32_t> view;               ///< of each point
    std::vector<double> u;                         ///< distance of each point from the seam, mm
    std::vector<Eigen::Vector3d> places, normals;  ///< of the measured places, of all when none is
    std::size_t reach = 1;                         ///< places to each side that share a window
    double correlation = 1;  ///< variance of means over that of as many independent points, of those taken
    double scale = 0;        ///< robust 1-sigma of the points about the windows' own surfaces, mm
};

/// The points of all places, thinned evenly where there are many. A window reaches `reach` places to each side, as far
/// as the seam has several windows; `correlation` as in ScanScale.
FlankPool pool_of(std::span<const FlankPlace> places, std::size_t reach, double correlation);

}  // namespace seampath
