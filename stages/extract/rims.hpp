#pragma once

#include <string>
#include <vector>

#include "stages/extract/around.hpp"

namespace seampath::detail {

/// A track that turned out to be a line in which two surfaces meet.
struct Fold {
    std::vector<TrackPoint> way;
    bool closed = false;
    bool convex = false;         ///< `way` is inside out: its normals point into the material
    SeamSurfaces surfaces = {};  ///< in the frame of `way`
};

double length_of(const std::vector<TrackPoint>& way);  ///< mm

/// Every block has convex edges, and every plate a rim. A convex edge is a corner joint where two faces of comparable
/// width meet along more than a fraction of it, and neither of them is known from its other edge as a plate's rim.
/// Takes those that are none out of `edges`, with a remark each. `max_thickness` (mm): faces up to this width are rims;
/// 0: faces up to a third as wide as the other; where the plate shows other rims and they are narrower, up to a
/// quarter.
void leave_out_rims(const Around& around, double max_thickness, std::vector<Fold>& edges,
                    std::vector<std::string>& remarks);

}  // namespace seampath::detail
