#pragma once

#include <vector>

#include <Eigen/Core>

#include "stages/extract/surfels.hpp"

namespace seampath::detail {

/// A place where two planes explain the neighbourhood and one does not: a seed, good to a fraction of the
/// neighbourhood, never reported as a seam point.
struct Crease {
    Eigen::Vector3d p;   ///< on the line in which the planes meet, mm
    Eigen::Vector3d t;   ///< unit, along n1 x n2
    Eigen::Vector3d n1;  ///< unit, out of the material
    Eigen::Vector3d n2;
    double weight = 0;  ///< surfels explained
    bool concave = false;
    std::uint32_t piece = 0;        ///< of the scan, see Surfel
    AirSide side = AirSide::known;  ///< how sure `concave` is; it may be that the normals are the other way round
};

/// Robust two-plane fits at every surfel that is not flat, in the order of the surfels.
std::vector<Crease> find_creases(const Surfels& surfels, const ScaleField& field);

}  // namespace seampath::detail
