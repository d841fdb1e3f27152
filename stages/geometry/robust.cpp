#include "stages/geometry/robust.hpp"

namespace seampath {
namespace {

constexpr double kTukey = 4.685;
constexpr double kMadToSigma = 1.4826;
constexpr int kRounds = 6;

}  // namespace

bool QuadraticFit::least_squares() {
    // Moments first: the normal matrix of a quadratic in two variables has 15 different entries.
    double m[5][5] = {}, z[3][3] = {};
    for (std::size_t i = 0; i < z_.size(); ++i) {
        const double w = weight_[i];
        if (w == 0) {
            continue;
        }
        const double u = u_[i], s = s_[i];
        double wu = w;
        for (int a = 0; a <= 4; ++a, wu *= u) {
            double wus = wu;
            for (int b = 0; a + b <= 4; ++b, wus *= s) {
                m[a][b] += wus;
                if (a + b <= 2) {
                    z[a][b] += wus * straight_[i];
                }
            }
        }
    }
    static constexpr int power[6][2] = {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}};
    Coefficients right;
    for (int i = 0; i < 6; ++i) {
        right[i] = z[power[i][0]][power[i][1]];
        for (int j = 0; j < 6; ++j) {
            normal_(i, j) = m[power[i][0] + power[j][0]][power[i][1] + power[j][1]];
        }
    }
    const Eigen::LDLT<Normal> ldlt(normal_);
    const auto pivots = ldlt.vectorD();
    if (ldlt.info() != Eigen::Success || !(pivots.minCoeff() > 1e-10 * pivots.maxCoeff())) {
        return false;
    }
    c_ = ldlt.solve(right);
    return c_.allFinite();
}

void QuadraticFit::take_curvature() {
    constexpr double kMostRise = 0.5;  // of a radius over the tangent plane: beyond, a surface is no graph over it
    if (u_length_ <= 0) {
        return;
    }
    const double uu = 2 * c_[3] / (u_length_ * u_length_), us = c_[4] / (u_length_ * s_length_),
                 ss = 2 * c_[5] / (s_length_ * s_length_);
    const double mean = (uu + ss) / 2, rise = std::abs(c_[3]) + std::abs(c_[4]) + std::abs(c_[5]);
    const double k = mean + std::copysign(std::hypot((uu - ss) / 2, us), mean);
    const double slope_u = c_[1] / u_length_, slope_s = c_[2] / s_length_;
    const bool graph = std::abs(k) * rise < kMostRise;
    middle_ = c_[0];
    bulge_ = graph ? k : 0;
    tilt_u_ = graph ? ((uu - k) * slope_u + us * slope_s) * u_length_ : 0;
    tilt_s_ = graph ? (us * slope_u + (ss - k) * slope_s) * s_length_ : 0;
    for (std::size_t i = 0; i < z_.size(); ++i) {
        straight_[i] = straightened(u_[i], s_[i], z_[i]);
    }
}

bool QuadraticFit::solve(double least_scale) {
    const std::size_t n = z_.size();
    if (n < 12) {
        return false;
    }
    weight_.assign(n, 1);
    residual_.resize(n);
    straight_ = z_;
    std::vector<double> magnitude(n);
    for (int round = 0; round < kRounds; ++round) {
        if (!least_squares()) {
            return false;
        }
        take_curvature();
        for (std::size_t i = 0; i < n; ++i) {
            residual_[i] = straight_[i] - value(u_[i], s_[i]);
            magnitude[i] = std::abs(residual_[i]);
        }
        const double before = scale_;
        scale_ = std::max(least_scale, kMadToSigma * quantile(magnitude, 0.5) *
                                           std::sqrt(static_cast<double>(n) / static_cast<double>(n - 6)));
        if (scale_ <= 0) {
            weight_.assign(n, 1);  // exact data: nothing to weigh down
            return true;
        }
        for (std::size_t i = 0; i < n; ++i) {
            const double x = residual_[i] / (kTukey * scale_);
            weight_[i] = std::abs(x) < 1 ? (1 - x * x) * (1 - x * x) : 0;
        }
        if (round > 1 && std::abs(scale_ - before) < 1e-3 * scale_) {
            break;
        }
    }
    return least_squares();
}

void QuadraticFit::shrink(double unit) {
    constexpr double kLeastPrior =
        0.25;  // of a coefficient's variance: that one came out small does not prove it nought
    const Normal covariance = unit * unit * cofactors();
    const Coefficients right = normal_ * c_;
    for (int i = 3; i < 6; ++i) {
        const double variance = covariance(i, i);
        if (variance > 0) {
            normal_(i, i) += unit * unit / std::max(c_[i] * c_[i] - variance, kLeastPrior * variance);
        }
    }
    c_ = normal_.ldlt().solve(right);
}

}  // namespace seampath
