#pragma once

#include <vector>

#include "pipeline/result.hpp"

/// What was fitted to a seam's flanks, cut by a plane square to the seam.
namespace seampath {

/// A plane square to a seam.
struct SectionPlane {
    Eigen::Vector3d p, t, x, y;
    Eigen::Vector2d n[2];  ///< flank normals
    Eigen::Vector2d d[2];  ///< away from the seam within the flanks

    Eigen::Vector2d in_plane(const Eigen::Vector3d& v) const { return {v.dot(x), v.dot(y)}; }
    Eigen::Vector3d in_space(const Eigen::Vector2d& q) const { return p + q.x() * x + q.y() * y; }
};

using Trace = std::vector<Eigen::Vector2d>;  ///< a polyline in the plane, mm

/// Of both flanks at a sample, as far as `points` of the scan in the plane lie on them; of butt joints and grooves the
/// faces as extraction measured them. None lies farther than `reach` from the seam.
std::vector<Trace> section_traces(const PartResult& part, const Seam& seam, const SectionPlane& plane,
                                  const std::vector<Eigen::Vector2d>& points, const DeviationSample& sample,
                                  double reach);

}  // namespace seampath
