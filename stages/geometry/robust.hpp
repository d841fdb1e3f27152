#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace seampath {

/// The q-quantile (0..1) of the values, by rank; reorders them. 0 for none.
double quantile(std::vector<double>& values, double q);

/// Robust fit of z = c0 + c1 u + c2 s + c3 u^2 + c4 u s + c5 s^2 by iteratively re-weighted least squares with Tukey's
/// biweight (c = 4.685, 95 % efficient for Gaussian noise) and the scale from the median absolute residual.
/// u and s should be of order 1.
///
/// A cylinder or sphere is no parabola: over its tangent plane, with the quadratic form q and the curvature k (of
/// larger modulus), its height is h = q + k h^2 / 2 exactly. Given the lengths that u and s stand for, the fit takes k
/// from itself and the quadratic is fitted to h - k h^2 / 2. At u = s = 0 height, slope and curvature are those of the
/// quadratic.
class QuadraticFit {
public:
    using Coefficients = Eigen::Matrix<double, 6, 1>;
    using Normal = Eigen::Matrix<double, 6, 6>;

    static Coefficients row(double u, double s) { return (Coefficients() << 1, u, s, u * u, u * s, s * s).finished(); }

    /// `u_length`, `s_length`: what one unit of u and s stands for, in the unit of z; 0: the surface is the quadratic
    /// alone.
    void begin(std::size_t expected, double u_length = 0, double s_length = 0) {
        u_.clear(), s_.clear(), z_.clear();
        u_.reserve(expected), s_.reserve(expected), z_.reserve(expected);
        u_length_ = u_length, s_length_ = s_length;
        bulge_ = tilt_u_ = tilt_s_ = 0;
    }
    void add(double u, double s, double z) { u_.push_back(u), s_.push_back(s), z_.push_back(z); }
    std::size_t size() const { return z_.size(); }
    double u(std::size_t i) const { return u_[i]; }
    double s(std::size_t i) const { return s_[i]; }
    double z(std::size_t i) const { return z_[i]; }

    /// False when the points do not determine the six coefficients. `least_scale` keeps the scale from collapsing on
    /// data that are exact or quantised, same unit as z.
    bool solve(double least_scale);

    /// Shrinks each second-order coefficient towards 0 as far as its uncertainty, at `unit` (1-sigma of one point for
    /// the purpose of means, same unit as z), leaves it in doubt: positive-part shrinkage (James & Stein 1961) as a
    /// ridge. A flat surface is then known nearly as well as if it had been known to be flat. cofactors() then are
    /// those of the posterior.
    void shrink(double unit);

    const Coefficients& coefficients() const { return c_; }
    double scale() const { return scale_; }                    ///< robust 1-sigma of the residuals
    double weight(std::size_t i) const { return weight_[i]; }  ///< 0..1, 0 for outliers
    double residual(std::size_t i) const { return residual_[i]; }
    double share_taken() const {  ///< of the points, with a weight above 0
        return 1 - static_cast<double>(std::count(weight_.begin(), weight_.end(), 0.0)) /
                       static_cast<double>(weight_.size());
    }
    double value(double u, double s) const { return row(u, s).dot(c_); }  ///< of the quadratic
    /// What is left of a point's height when the surface is taken off.
    double residual(double u, double s, double z) const {
        return straightened(u, s, z) - (c_[0] + c_[1] * u + c_[2] * s + c_[3] * u * u + c_[4] * u * s + c_[5] * s * s);
    }
    /// Inverse of the weighted normal matrix: times scale^2 it is the covariance for uncorrelated noise.
    Normal cofactors() const { return normal_.ldlt().solve(Normal::Identity()); }

private:
    bool least_squares();
    void take_curvature();
    void measure_residuals();
    // The tilted frame adds terms in h u and h s: in three dimensions n.v = v^T M v / 2 with M n = k n.
    double straightened(double u, double s, double z) const {
        const double h = z - middle_;
        return z - h * (0.5 * bulge_ * h + tilt_u_ * u + tilt_s_ * s);
    }

    std::vector<double> u_, s_, z_, straight_, weight_, residual_, magnitude_;
    Coefficients c_ = Coefficients::Zero();
    Normal normal_;
    double u_length_ = 0, s_length_ = 0;
    double middle_ = 0, bulge_ = 0, tilt_u_ = 0, tilt_s_ = 0;
    double scale_ = 0;
};

}  // namespace seampath
