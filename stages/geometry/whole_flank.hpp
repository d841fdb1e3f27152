#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "stages/geometry/flank_pool.hpp"
#include "stages/geometry/surface_fit.hpp"

/// A flank as one surface along a whole seam, told by all its points and not only by those of one window.
namespace seampath {

/// What a place departs from a surface, at the seam, along the normal; mm and mm^2.
struct Departure {
    double value = 0, variance = 0;
};

/// Share of points that a surface must explain to be what they lie on.
inline constexpr double kLeastExplained = 0.85;

struct WholeFlank {
    SurfaceFit surface;
    std::vector<Departure> at;  ///< of each place: what is kept of its departure, and the variance of all
    std::vector<double> share;  ///< 0..1, how far each place goes by this surface and not by its own window
    std::vector<double> taken;  ///< 0..1, of the points that tell of each place: how many the surface explains
    double variance = 0;        ///< typical, of the place of the seam across the flank, mm^2
};

struct FlankFit {
    std::optional<SurfaceFit> nearest;  ///< the plane or cylinder that is nearest to all points
    std::optional<WholeFlank> whole;    ///< empty where no such surface explains the points as the windows do
};

struct WholeFlankRules {
    std::size_t reach = 1;           ///< places to each side whose points tell a departure
    double least_scale = 0;          ///< mm, as for fit_plane()
    std::size_t least_points = 100;  ///< of the pool
    bool mixes_views = false;        ///< windows mix points of views that lie off each other
};

/// Fits a plane and a cylinder to all points of the pool. Where one explains them, what each place departs from it is
/// kept as far as it is more than noise: a random effect, shrunk by its share of the variance.
FlankFit fit_whole_flank(std::span<const FlankPlace> places, const FlankPool& pool, const WholeFlankRules& rules);

}  // namespace seampath
