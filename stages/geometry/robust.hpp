#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Cholesky>

namespace seampath {

/// The q-quantile (0..1) of the values, by rank; reorders them. 0 for none.
inline double quantile(std::vector<double>& values, double q) {
    if (values.empty()) {
        return 0;
    }
    const auto k = static_cast<std::ptrdiff_t>(std::lround(q * static_cast<double>(values.size() - 1)));
    std::nth_element(values.begin(), values.begin() + k, values.end());
    return values[static_cast<std::size_t>(k)];
}

/// Robust fit of z = c0 + c1 u + c2 s + c3 u^2 + c4 u s + c5 s^2 by iteratively re-weighted least squares with Tukey's
/// biweight (c = 4.685, 95 % efficient for Gaussian noise) and the scale from the median absolute residual.
/// u and s should be of order 1.
class QuadraticFit {
public:
    using Coefficients = Eigen::Matrix<double, 6, 1>;
    using Normal = Eigen::Matrix<double, 6, 6>;

    static Coefficients row(double u, double s) { return (Coefficients() << 1, u, s, u * u, u * s, s * s).finished(); }

    void begin(std::size_t expected) {
        u_.clear(), s_.clear(), z_.clear();
        u_.reserve(expected), s_.reserve(expected), z_.reserve(expected);
    }
    void add(double u, double s, double z) { u_.push_back(u), s_.push_back(s), z_.push_back(z); }
    std::size_t size() const { return z_.size(); }
    double u(std::size_t i) const { return u_[i]; }
    double s(std::size_t i) const { return s_[i]; }

    /// False when the points do not determine the six coefficients. `least_scale` keeps the scale from collapsing on data
    /// that are exact or quantised, same unit as z.
    bool solve(double least_scale);

    /// Shrinks each second-order coefficient towards 0 as far as its uncertainty, at `unit` (1-sigma of one point for the
    /// purpose of means, same unit as z), leaves it in doubt: positive-part shrinkage (James & Stein 1961) as a ridge. A flat
    /// surface is then known nearly as well as if it had been known to be flat. cofactors() then are those of the posterior.
    void shrink(double unit);

    const Coefficients& coefficients() const { return c_; }
    double scale() const { return scale_; }                                ///< robust 1-sigma of the residuals
    double weight(std::size_t i) const { return weight_[i]; }              ///< 0..1, 0 for outliers
    double residual(std::size_t i) const { return residual_[i]; }
    double share_taken() const {                                            ///< of the points, with a weight above 0
        return 1 - static_cast<double>(std::count(weight_.begin(), weight_.end(), 0.0)) / static_cast<double>(weight_.size());
    }
    double value(double u, double s) const { return row(u, s).dot(c_); }
    /// Inverse of the weighted normal matrix: times scale^2 it is the covariance for uncorrelated noise.
    Normal cofactors() const { return normal_.ldlt().solve(Normal::Identity()); }

private:
    bool least_squares();

    std::vector<double> u_, s_, z_, weight_, residual_;
    Coefficients c_;
    Normal normal_;
    double scale_ = 0;
};

}  // namespace seampath
