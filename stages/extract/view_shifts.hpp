#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "stages/extract/track.hpp"

/// By how much each view is shifted, told from all flanks of a scan together, and what of it stays unknown.
namespace seampath::detail {

/// Shares that the views have in a measured place of a flank: how far the place moves when a view moves, by axis, and
/// when what the view shows of this one flank moves along the normal.
struct ViewShares {
    Eigen::VectorXd by_axis;    ///< 3 numbers a view
    Eigen::VectorXd by_normal;  ///< 1 number a view
};

/// Of each place of a way, across flank k: measured by a parabola through the points about it, over their distances
/// from the seam; by their mean, where it is a wall whose angle is known.
std::vector<ViewShares> shares_of_windows(const Tracker& tracker, const std::vector<TrackPoint>& way, std::size_t k);

/// The places of a seam, and with what they were measured.
struct MeasuredWay {
    Tracker tracker;
    std::vector<TrackPoint>* places;
};

/// A mixed linear model (Henderson 1975) of how far views lie off each other on the flanks of a scan, stretch by
/// stretch. Each view has a shift of its own, normal with the same variance along each axis. It shows each flank off by
/// a bias of its own besides: noise that its rows share all along the flank, the less the more points it has there; a
/// view that hardly sees a flank sees it beside a shadow. The surface under the points is free on every stretch. How
/// large biases and noise are, in the variance that the points' scatter says, is what makes the scan most likely. The
/// shift that all views have in common is in no scan: it stays as unknown as before.
class ViewShifts {
public:
    /// What is unknown of where a place lies along the normal.
    struct Unknown {
        Eigen::VectorXd by_shift;  ///< how far it goes with the views' shifts: 3 numbers a view
        double variance = 0;       ///< mm^2
    };

    /// Flank k of way w is number 2 w + k. `registration` (mm): 1-sigma of a shift along one axis; 0: there are none.
    ViewShifts(std::span<const MeasuredWay> ways, double registration);

    std::size_t views() const { return views_; }

    /// The most likely shift, mm, of a view's points on a flank whose normal is `n`.
    Eigen::Vector3d of(std::size_t flank, std::size_t view, const Eigen::Vector3d& n) const;
    /// The same of a place with these shares, along the normal.
    double of(std::size_t flank, const ViewShares& shares) const;
    /// What stays unknown of that.
    Unknown unknown(std::size_t flank, const ViewShares& shares) const;
    /// Covariance of what stays unknown of places on two flanks, mm^2.
    double covariance(const Unknown& one, const Unknown& other) const;

private:
    struct Flank;
    /// `noise` and `bias`: their variances over that of as many points with independent noise.
    double settle(const std::vector<Flank>& flanks, double shift_variance, double noise, double bias);

    std::size_t views_ = 1;
    Eigen::VectorXd shift_;             ///< 3 numbers a view
    Eigen::MatrixXd shift_covariance_;  ///< of them
    struct Bias {
        Eigen::VectorXd value;       ///< 1 number a view
        Eigen::MatrixXd covariance;  ///< of them where the shifts are known
        Eigen::MatrixXd by_shift;    ///< what a change of the shifts changes of them, with the sign turned
    };
    std::vector<Bias> bias_;  ///< of each flank; empty without registration
};

/// Moves the points of all slabs back by their views' shifts, and each place with them. `first` is the number of the
/// way's first flank.
void take_back(const Tracker& tracker, const ViewShifts& shifts, std::size_t first, std::vector<TrackPoint>& way);

}  // namespace seampath::detail
