#pragma once

#include <vector>

#include "stages/geometry/banded.hpp"
#include "stages/geometry/bspline.hpp"

namespace seampath {

/// Points of a curve with the parameters at which it should pass them and their weights, 1/mm^2. `u` ascends but for
/// noise.
struct CurvePoints {
    std::vector<Eigen::Vector3d> p;
    std::vector<double> u;
    std::vector<double> weight;
};

/// How well a curve is known at one parameter.
struct CurveSigma {
    double u = 0;
    double sigma_mm = 0;  ///< 1-sigma along each of the two directions across the curve
};

/// A curve through the points, and how many coefficients of one coordinate the points decide.
struct FittedCurve {
    CubicBSpline curve;
    double freedom = 0;
    std::vector<CurveSigma> sigma;  ///< ascending; empty where it is not known
};

/// A break at every point, but for those that crowd; `end` is that of the curve.
std::vector<double> breaks_at(const CurvePoints& points, double end);

/// Lambdas that leave a curve about one coefficient for every two points.
std::vector<double> loose_lambda(const CurvePoints& points, const std::vector<double>& breaks);

/// Penalised least-squares cubic spline (Eilers & Marx 1996; O'Sullivan 1986): the curve c between given breaks that
/// minimises
///     sum_i w_i |c(u_i) - p_i|^2 + sum_k lambda_k h_k |c'''_k|^2,
/// where c''' is constant on span k of width h_k. A penalty on the third derivative leaves parabolas as they are and
/// takes little from arcs. Solved in O(points + spans).
class PenalisedSpline {
public:
    /// `breaks` ascend strictly; at least 2, or 5 when periodic.
    PenalisedSpline(const std::vector<double>& breaks, bool periodic);

    void take(const CurvePoints& points);
    /// One lambda per span, mm^4; it is held within what double precision can tell from none and from endless.
    void solve(std::vector<double>& lambda);

    std::size_t spans() const { return third_.size(); }
    const std::vector<double>& breaks() const { return breaks_; }
    const CubicBSpline& curve() const { return curve_; }
    Eigen::Vector3d at_point(std::size_t point) const;               ///< of the curve, at the point's parameter
    double freedom() const { return inverse_.trace_with(normal_); }  ///< trace of the hat matrix
    double leverage(std::size_t point) const;                        ///< diagonal of the hat matrix, 0..1
    /// Variance of one coordinate at u when the points have 1 / w_i: that of a curve whose third derivative is as
    /// random as the penalty has it, given the points (Wahba 1983). It holds what noise and, on average along the
    /// curve, stiffness do.
    double variance(double u) const;
    double roughness(std::size_t span) const;  ///< h |c'''|^2, 1/mm^3
    double freedom(std::size_t span,
                   double lambda) const;  ///< 0..1: share of c''' on the span that the points decide, not the penalty

private:
    struct Span {
        std::array<std::size_t, 4> control;
        std::array<double, 4> third;  ///< c''' as a combination of the control points
        double width;
    };
    std::vector<double> breaks_;
    CubicBSpline curve_;
    std::vector<Span> third_;
    std::vector<double> u_;          ///< of the points
    std::vector<CubicBasis> basis_;  ///< there
    std::vector<double> weight_;
    BandedMatrix normal_, inverse_;
    std::vector<Eigen::RowVector3d> right_;
};

}  // namespace seampath
