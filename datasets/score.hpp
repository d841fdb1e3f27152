#pragma once

#include <span>
#include <vector>

#include "datasets/scenes.hpp"
#include "stages/types.hpp"

namespace seampath {

/// A reported curve and a true seam correspond where they are no further apart than this.
inline constexpr double kCorrespondence = 1.5;  // mm

/// How a result compares with the truth. Distances are from the points of the reported curves to the true curve (not to
/// its samples), each point weighted by the length that it stands for; they cover the parts that correspond to a true
/// seam. An open seam is taken to go on straight beyond its ends by the range of correspondence: reaching too far is an
/// error of the ends, not of the curve. Where there is no true seam at all, everything is found, and the false share of
/// whatever is reported is infinite.
struct Score {
    double rms_mm = 0;
    double p95_mm = 0;
    double max_mm = 0;
    double found = 0;                   ///< share of the true length near a reported curve
    double false_share = 0;             ///< length reported where there is no seam, over the true length
    double repeated_share = 0;          ///< length reported more than once, over the true length
    std::vector<double> end_errors_mm;  ///< first and last end of each open true seam: distance along the seam to the
                                        ///< nearest end of a reported curve; the seam's length when there is none
    double wrong_kind_share = 0;        ///< length near a true seam, reported as another kind of joint than the seam
                                        ///< is, over the true length
    double p50_mm = 0;
    /// The distances' two parts in the true section: `vertical` along n1 + n2, out of the joint, `lateral` along
    /// tangent x (n1 + n2); signed means, rms and the largest size.
    double lateral_mean_mm = 0;
    double lateral_rms_mm = 0;
    double lateral_max_mm = 0;
    double vertical_mean_mm = 0;
    double vertical_rms_mm = 0;
    double vertical_max_mm = 0;
    double tangent_p95_deg = 0;  ///< between a model's tangent and the true one, whichever way it goes, since a scan
                                 ///< does not say which flank is the first; 0 for extracted points
};

/// The place of the nearest true seam to a point: its frame there, n1 and n2 unit, and the distance, which is infinite
/// where no true seam corresponds.
struct TruthFoot {
    double distance_mm = 0;
    TruthPoint at;
};
std::vector<TruthFoot> truth_feet(std::span<const Eigen::Vector3d> points, const Truth& truth);

/// The value below which a share of the weights lies; 0 for no values. Values and their weights, in any order.
double weighted_quantile(std::vector<std::pair<double, double>> value_and_weight, double share);

/// Compares extracted seams, by their points.
Score score(std::span<const Seam> seams, const Truth& truth);

/// Compares fitted models, by points of their curves every 0.25 mm.
Score score(std::span<const SeamModel> models, const Truth& truth);

}  // namespace seampath
