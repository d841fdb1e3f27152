#pragma once

#include "stages/options.hpp"
#include "stages/types.hpp"

namespace seampath {

/// Nothing to choose: how smooth the curve is follows from the points.
struct FitOptions {};
Fields describe(FitOptions&);

/// Penalised least-squares cubic B-spline through the seam points (Eilers & Marx 1996), periodic when the seam is
/// closed. Points count with 1/sigma^2, of which only the ratios matter unless the points scatter less than stated;
/// single points that are off from their neighbours don't count. Distances are orthogonal. How stiff the curve is, and
/// where, is chosen from the points (smoothing.hpp), knots are as dense as the freedom that it turns out to have. The
/// nodes are not needed: every point takes part. Time is O(points). Throws InputError for fewer than 6 points or a seam
/// without length.
SeamModel fit(const Seam& seam, const Nodes& nodes, const FitOptions& options);

}  // namespace seampath
