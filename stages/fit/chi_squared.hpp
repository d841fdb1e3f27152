#pragma once

#include <vector>

#include <Eigen/Core>

namespace seampath {

/// 99 % point of chi-squared over its degrees of freedom, from one on, to 2 % (Wilson & Hilferty 1931).
double chi_squared_limit(double freedom);

/// Whether residuals along a seam are what their sigmas allow.
struct ChiSquared {
    double per_freedom = 0;  ///< mean square of the residuals, in their own sigmas
    double limit = 0;        ///< its 99 % point, if the sigmas are true
    double freedom = 0;      ///< independent residuals
    bool holds() const { return per_freedom <= limit; }
};

/// `z` are residuals across the seam, over their sigmas, in order along it. Neighbours share windows, and whole
/// stretches the shifts of views, so that their squares scatter as those of fewer: n / sum_k rho_k^2, rho_k the
/// correlation at lag k (the variance of a sum of correlated squares, matched to a chi-squared one: Satterthwaite 1946;
/// Bayley & Hammersley 1946). As if all of them lay in one direction across the seam, which makes fewest.
ChiSquared chi_squared(const std::vector<Eigen::Vector2d>& z, bool closed);

}  // namespace seampath
