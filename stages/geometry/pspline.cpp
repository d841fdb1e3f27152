#include "stages/geometry/pspline.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "stages/error.hpp"
#include "stages/geometry/robust.hpp"

namespace seampath {
namespace {

// Of the penalty's mean diagonal entry against that of the points: below, a span without points would float; above, too
// few digits of the points are left.
constexpr double kLeastPenalty = 1e-9, kMostPenalty = 1e8;

std::size_t controls_of(std::size_t breaks, bool periodic) {
    return periodic ? breaks - 1 : breaks + 2;
}

}  // namespace

std::vector<double> breaks_at(const CurvePoints& points, double end) {
    const double apart = 0.3 * end / static_cast<double>(points.p.size());
    std::vector<double> breaks{0};
    for (const double u : points.u) {
        if (u > breaks.back() + apart && u < end - apart) {
            breaks.push_back(u);
        }
    }
    breaks.push_back(end);
    return breaks;
}

std::vector<double> loose_lambda(const CurvePoints& points, const std::vector<double>& breaks) {
    // The penalty halves a wave of angular frequency f at lambda f^6 = weight / spacing; here f is half of what points
    // of that spacing can carry.
    const double spacing = (breaks.back() - breaks.front()) / static_cast<double>(points.p.size());
    std::vector<double> weight = points.weight;
    return std::vector<double>(breaks.size() - 1,
                               quantile(weight, 0.5) * std::pow(spacing, 5) / std::pow(0.5 * std::numbers::pi, 6));
}

PenalisedSpline::PenalisedSpline(const std::vector<double>& breaks, bool periodic)
    : breaks_(breaks), normal_(controls_of(breaks.size(), periodic), periodic), inverse_(normal_) {
    curve_.periodic = periodic;
    curve_.knots = breaks;
    if (!periodic) {
        curve_.knots.insert(curve_.knots.begin(), 3, breaks.front());
        curve_.knots.insert(curve_.knots.end(), 3, breaks.back());
    }
    const std::size_t n = controls_of(breaks.size(), periodic);
    curve_.control.assign(n, Eigen::Vector3d::Zero());
    for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
        const double h = breaks[k + 1] - breaks[k];
        // c'' is linear within the span.
        const CubicBasis a = cubic_basis(curve_.knots, n, periodic, breaks[k] + 0.25 * h);
        const CubicBasis b = cubic_basis(curve_.knots, n, periodic, breaks[k] + 0.75 * h);
        Span span{a.control, {}, h};
        for (int r = 0; r < 4; ++r) {
            span.third[r] = (b.d2[r] - a.d2[r]) / (0.5 * h);
        }
        third_.push_back(span);
    }
}

void PenalisedSpline::take(const CurvePoints& points) {
    const std::size_t n = curve_.control.size();
    weight_ = points.weight;
    normal_ = BandedMatrix(n, curve_.periodic);
    right_.assign(n, Eigen::RowVector3d::Zero());
    if (u_ != points.u) {
        u_ = points.u;
        basis_.clear();
        for (const double u : u_) {
            basis_.push_back(cubic_basis(curve_.knots, n, curve_.periodic, u));
        }
    }
    for (std::size_t i = 0; i < points.p.size(); ++i) {
        const CubicBasis& basis = basis_[i];
        normal_.add_square(basis.control, basis.value, weight_[i]);
        for (int r = 0; r < 4; ++r) {
            right_[basis.control[r]] += weight_[i] * basis.value[r] * points.p[i].transpose();
        }
    }
}

void PenalisedSpline::solve(std::vector<double>& lambda) {
    BandedMatrix A = normal_;
    const double diagonal = normal_.mean_diagonal();
    for (std::size_t k = 0; k < third_.size(); ++k) {
        const Span& span = third_[k];
        double square = 0;
        for (const double d : span.third) {
            square += d * d;
        }
        const double unit = diagonal / (square * span.width);
        lambda[k] = std::clamp(lambda[k], kLeastPenalty * unit, kMostPenalty * unit);
        A.add_square(span.control, span.third, lambda[k] * span.width);
    }
    ensure(A.factorise(), "the normal matrix of a penalised spline is positive definite");
    const std::vector<Eigen::RowVector3d> x = A.solve(right_);
    for (std::size_t i = 0; i < x.size(); ++i) {
        curve_.control[i] = x[i].transpose();
    }
    inverse_ = A.inverse();
}

Eigen::Vector3d PenalisedSpline::at_point(std::size_t point) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int r = 0; r < 4; ++r) {
        sum += basis_[point].value[r] * curve_.control[basis_[point].control[r]];
    }
    return sum;
}

double PenalisedSpline::leverage(std::size_t point) const {
    return weight_[point] * inverse_.square(basis_[point].control, basis_[point].value);
}

double PenalisedSpline::variance(double u) const {
    const CubicBasis basis = cubic_basis(curve_.knots, curve_.control.size(), curve_.periodic, u);
    return inverse_.square(basis.control, basis.value);
}

double PenalisedSpline::roughness(std::size_t k) const {
    Eigen::Vector3d third = Eigen::Vector3d::Zero();
    for (int r = 0; r < 4; ++r) {
        third += third_[k].third[r] * curve_.control[third_[k].control[r]];
    }
    return third_[k].width * third.squaredNorm();
}

double PenalisedSpline::freedom(std::size_t k, double lambda) const {
    return std::clamp(1 - lambda * third_[k].width * inverse_.square(third_[k].control, third_[k].third), 0.0, 1.0);
}

}  // namespace seampath
