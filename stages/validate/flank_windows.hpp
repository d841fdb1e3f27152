#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "stages/geometry/slab.hpp"
#include "stages/geometry/surface_fit.hpp"
#include "stages/types.hpp"
#include "stages/validate/ground.hpp"

namespace seampath::detail {

/// What all samples have in common.
struct Course {
    const Ground& ground;
    SectionWindows limits;
    double step = 0;  ///< mm between samples
    double outwards = 1;
    bool closed = false;
};

/// One sample, with its own window. A corner is measured inside out: from within the material it is concave.
struct Window {
    Section model;            ///< the model's point and normals
    Eigen::Vector3d t, d[2];  ///< along the seam, and away from it on each flank
    std::optional<SectionFit> fit;
    std::vector<SlabPoint> slab[2];     ///< points on and near each flank up to half a step to each side
    bool explains[2] = {false, false};  ///< whether the fit is the surface that these points lie on

    const Eigen::Vector3d& normal(std::size_t k) const { return k == 0 ? model.n1 : model.n2; }
};

/// Each sample with its window: fits of both flanks about it, where there are enough points.
std::vector<Window> windows_along(const Course& course, const SeamModel& model,
                                  const std::vector<DeviationSample>& samples);

/// A window that leaves flank k less sure than two scan points tells nothing of where it is.
bool is_sure(const Course& course, const Window& window, std::size_t k);

/// How far from the seam the windows see flank k, usually; as far as they may when none is sure.
SectionWindow usual_extent(const Course& course, const std::vector<Window>& windows, std::size_t k);

/// Sets the points of windows that are sure of flank k, and whether their surfaces explain what is right beside the
/// sample: a wide window may pass over a short dent.
void take_slabs(const Course& course, std::vector<Window>& windows, std::size_t k);

/// Sets the points of flank k by the model's normals alone, where windows see too little to say where the flank is.
void look_by_model(const Course& course, std::vector<Window>& windows, std::size_t k);

/// Sets the window's points of flank k by a surface that the rest of the seam has told of.
void look_on_surface(const Course& course, const SurfaceFit& surface, const SectionWindow& extent, std::size_t k,
                     Window& window);

}  // namespace seampath::detail
