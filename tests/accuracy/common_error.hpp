#pragma once

#include "datasets/dataset.hpp"

/// The part of a seam's error that no method can see.
namespace seampath {

/// The truth, moved as the views that saw it were moved together. The views of a scan are registered to each other and
/// to nothing else: how far two of them lie apart is in the points, where their mean lies is not. Each flank moves by
/// the mean of the errors of the views that see it anywhere beside its seam, and the seam to where the moved flanks
/// meet; the tops of a butt joint, which do not meet, by the mean of both. What is left of a seam's error against this
/// truth is what a better method could take away; errors of all views alike, such as the sensor's scale, move it too.
Truth moved_with_views(const Dataset& dataset);

/// rms distance of the points of the moved truth from where they came, over all seams, mm; each point stands for the
/// same length.
double common_error(const Truth& truth, const Truth& moved);

}  // namespace seampath
