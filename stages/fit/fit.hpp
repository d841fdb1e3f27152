#pragma once

#include "stages/options.hpp"
#include "stages/types.hpp"

namespace seampath {

struct FitOptions {
    double max_residual_sigma = 1.2;
};
Fields describe(FitOptions&);

/// Least-squares cubic B-spline through the seam points, weighted by 1/sigma^2, periodic when the seam is closed; its knots
/// are the nodes, halved where the residuals say that they are too few.
SeamModel fit(const Seam& seam, const Nodes& nodes, const FitOptions& options);

}  // namespace seampath
