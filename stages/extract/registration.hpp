#pragma once

#include <vector>

#include "stages/extract/track.hpp"
#include "stages/extract/view_shifts.hpp"
#include "stages/geometry/flank_pool.hpp"
#include "stages/geometry/surface_fit.hpp"

/// What the views' registration against each other does to a seam. Each view is shifted by an error of its own, and no
/// fit over all of them sees the mean of it: only from how much views differ can it be told.
namespace seampath::detail {

/// How far the points of two views lie apart on one stretch of a flank, times the same on the next stretch: noise has
/// changed from one to the other, the shifts of the views have not.
struct ViewDifferences {
    double products = 0, pairs = 0;
};

/// Adds those of both flanks of a measured way.
void add_differences(ViewDifferences& sum, const std::vector<TrackPoint>& way);

/// 1-sigma of a view's shift along any one direction, mm; 0 where views differ by no more than their noise, or there is
/// one.
double registration_of(const ViewDifferences& sum);

/// What a seam's sigma takes a view's shift to be, mm: few views tell it badly, and two may agree by chance. A scan of
/// several views is taken to be registered to half of its noise before they are looked at, as if one more view had told
/// so; 0 for one view.
double registration_that_counts(double registration_mm, std::size_t views, double noise_mm);

/// How the views' shifts move a surface that was fitted to all of a flank's points.
class ShiftOfSurface {
public:
    ShiftOfSurface(const SurfaceFit& surface, const FlankPool& pool, std::size_t views);
    /// Of the surface at p, along its normal there.
    ViewShares at(const Eigen::Vector3d& p) const;

private:
    using Influence = Eigen::Matrix<double, Eigen::Dynamic, 4, 0, SurfaceFit::kMostParameters, 4>;
    const SurfaceFit& surface_;
    std::vector<Influence> influence_;  ///< of each view's shift by axis, and by normal, on the parameters
};

}  // namespace seampath::detail
