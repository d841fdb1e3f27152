#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pipeline/result.hpp"

/// The scan as it lies in planes square to a seam, for the report: what was measured there, and what was fitted to it.
namespace seampath {

/// One plane. The model's curve meets it at (0, 0); x is to the right of travel, y into the air, midway between the
/// flank normals; mm.
struct SeamSection {
    DeviationSample sample;
    double half_mm = 0;                   ///< scan points up to so far before and behind the plane are shown
    std::vector<Eigen::Vector2f> points;  ///< of the raw scan
    std::vector<std::vector<Eigen::Vector2f>> traces;  ///< polylines: the fitted flanks, as far as points lie on them
};

struct SeamSections {
    double reach_mm = 0;                ///< points are shown within this distance of the curve
    std::vector<SeamSection> sections;  ///< by station
};

/// Sections along every seam of a part with a scan, at even steps and at the worst places, where the flanks were
/// measured; some hundreds in all, a few hundred points each. The fitted flanks are cylinders, cones or spheres where
/// one explains a flank along the whole seam, of butt joints and grooves the faces that extraction measured, else
/// straight.
std::vector<SeamSections> seam_sections(const PartResult& part);

/// For the page: points and traces as base64 of little-endian 16-bit pairs, 32767 being reach_mm.
std::string sections_json(const std::vector<SeamSections>& seams);

}  // namespace seampath
