#pragma once

#include <optional>
#include <vector>

namespace seampath {

/// Where the points of a surface end along one coordinate.
struct DensityEdge {
    double at = 0;       ///< mm
    double sigma = 0;    ///< mm, 1-sigma of `at`
    double blur = 0;     ///< mm, 1-sigma width over which the density falls
    double density = 0;  ///< points per mm before the end
};

/// The place at which the density of points falls from what it is before to that of strays. `x`, in any order, are the
/// points' coordinates, mm; `from` is a place well before the end, mm; `bin` a few point distances, mm; `noise` the
/// points' 1-sigma along the coordinate, mm. The end is not the last point, which strays and noise move: the points'
/// number is taken for a Poisson process of intensity
///     lambda(x) = lambda Phi((e - x) / b) + lambda_0,
/// whose lambda_0 may be that of another face beyond the end, seen at a glance. It is the mean of the posterior over e,
/// b and lambda_0, and so is its sigma, which also holds what b has beyond the noise: a soft end may be a shadow's,
/// that lies before the surface's own. Empty when there are too few points about `from`.
std::optional<DensityEdge> density_edge(std::vector<double> x, double from, double bin, double noise);

}  // namespace seampath
