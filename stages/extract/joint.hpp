#pragma once

#include <array>

#include "stages/geometry/flank_pool.hpp"
#include "stages/geometry/surface_fit.hpp"
#include "stages/types.hpp"

namespace seampath::detail {

/// One flank of a seam, with the surface nearest to its points; null where none was fitted.
struct PooledFlank {
    const FlankPool* pool;
    const SurfaceFit* surface;
    bool explains;
};

/// Both flanks' surfaces together with the views' shifts: generalised least squares, in which each view is shifted by
/// an error of its own that is normal with the 1-sigma `registration` (mm) along each axis, and neighbouring points'
/// noise counts as much as blocks of points say. One fit over all points takes what views that differ have in the mean;
/// this one finds by how much they differ and leaves it out. What stays unknown is the mean of the shifts. The
/// covariances are of noise and shifts. `least_scale` as for fit_plane().
SeamSurfaces joint_surfaces(const std::array<PooledFlank, 2>& flanks, double registration, double least_scale);

}  // namespace seampath::detail
