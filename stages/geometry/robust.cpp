#include "stages/geometry/robust.hpp"

#include <array>
#include <limits>

namespace seampath {
namespace {

constexpr double kTukey = 4.685;
constexpr double kMadToSigma = 1.4826;
constexpr int kRounds = 6;

// The k-th smallest, from 0. Of many values a sample brackets it (Floyd & Rivest 1975), so that one pass without
// branches leaves few to look through.
double kth_smallest(std::vector<double>& values, std::size_t k) {
    constexpr std::size_t kSample = 256, kMargin = 24;  // 3 sigmas of a sample's median
    std::size_t below = 0, within = 0;
    if (values.size() >= 4 * kSample) {
        std::array<double, kSample> sample;
        for (std::size_t i = 0; i < kSample; ++i) {
            sample[i] = values[i * values.size() / kSample];
        }
        std::sort(sample.begin(), sample.end());
        const std::size_t rank = k * kSample / values.size();
        constexpr double kInfinity = std::numeric_limits<double>::infinity();
        const double low = rank < kMargin ? -kInfinity : sample[rank - kMargin],
                     high = rank + kMargin < kSample ? sample[rank + kMargin] : kInfinity;
        for (double& x : values) {
            const double value = x;
            below += value < low;
            x = values[within];
            values[within] = value;
            within += static_cast<std::size_t>(value >= low) & static_cast<std::size_t>(value <= high);
        }
    }
    const bool bracketed = below <= k && k < below + within;
    const std::size_t offset = bracketed ? below : 0;
    const auto end = bracketed ? values.begin() + static_cast<std::ptrdiff_t>(within) : values.end();
    const auto kth = values.begin() + static_cast<std::ptrdiff_t>(k - offset);
    std::nth_element(values.begin(), kth, end);
    return *kth;
}

using Entries = Eigen::Map<Eigen::ArrayXd>;

Entries array(std::vector<double>& values) {
    return {values.data(), static_cast<Eigen::Index>(values.size())};
}

}  // namespace

double quantile(std::vector<double>& values, double q) {
    return values.empty()
               ? 0
               : kth_smallest(values,
                              static_cast<std::size_t>(std::lround(q * static_cast<double>(values.size() - 1))));
}

bool QuadraticFit::least_squares() {
    // Moments first: the normal matrix of a quadratic in two variables has 15 different entries. Written out, two
    // points at a time, since most of the time of a measurement is spent here.
    using Pair = Eigen::Array2d;
    Pair m[5][5], z[3][3];
    std::fill_n(&m[0][0], 25, Pair::Zero());
    std::fill_n(&z[0][0], 9, Pair::Zero());
    const std::size_t n = z_.size();
    for (std::size_t i = 0; i < n; i += 2) {
        const std::size_t j = std::min(i + 1, n - 1);
        const Pair w(weight_[i], i + 1 < n ? weight_[j] : 0), u(u_[i], u_[j]), s(s_[i], s_[j]),
            x(straight_[i], straight_[j]);
        const Pair wu = w * u, ws = w * s, wuu = wu * u, wus = wu * s, wss = ws * s;
        const Pair wuuu = wuu * u, wuus = wuu * s, wuss = wus * s, wsss = wss * s;
        m[0][0] += w, m[1][0] += wu, m[0][1] += ws, m[2][0] += wuu, m[1][1] += wus, m[0][2] += wss;
        m[3][0] += wuuu, m[2][1] += wuus, m[1][2] += wuss, m[0][3] += wsss;
        m[4][0] += wuuu * u, m[3][1] += wuuu * s, m[2][2] += wuus * s, m[1][3] += wuss * s, m[0][4] += wsss * s;
        z[0][0] += w * x, z[1][0] += wu * x, z[0][1] += ws * x, z[2][0] += wuu * x, z[1][1] += wus * x;
        z[0][2] += wss * x;
    }
    static constexpr int power[6][2] = {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}};
    Coefficients right;
    for (int i = 0; i < 6; ++i) {
        right[i] = z[power[i][0]][power[i][1]].sum();
        for (int j = 0; j < 6; ++j) {
            normal_(i, j) = m[power[i][0] + power[j][0]][power[i][1] + power[j][1]].sum();
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
}

// By arrays, which use the processor's vector registers.
void QuadraticFit::measure_residuals() {
    const Entries u = array(u_), s = array(s_), z = array(z_);
    Entries straight = array(straight_), residual = array(residual_);
    straight = z - (z - middle_) * (0.5 * bulge_ * (z - middle_) + tilt_u_ * u + tilt_s_ * s);
    residual = straight - (c_[0] + c_[1] * u + c_[2] * s + c_[3] * u * u + c_[4] * u * s + c_[5] * s * s);
    array(magnitude_) = residual.abs();
}

bool QuadraticFit::solve(double least_scale) {
    const std::size_t n = z_.size();
    if (n < 12) {
        return false;
    }
    weight_.assign(n, 1);
    residual_.resize(n);
    straight_ = z_;
    magnitude_.resize(n);
    for (int round = 0; round < kRounds; ++round) {
        if (!least_squares()) {
            return false;
        }
        take_curvature();
        measure_residuals();
        const double before = scale_;
        scale_ = std::max(least_scale, kMadToSigma * quantile(magnitude_, 0.5) *
                                           std::sqrt(static_cast<double>(n) / static_cast<double>(n - 6)));
        if (scale_ <= 0) {
            weight_.assign(n, 1);  // exact data: nothing to weigh down
            return true;
        }
        array(weight_) = (1 - (array(residual_) / (kTukey * scale_)).square()).max(0).square();
        if (round > 1 && std::abs(scale_ - before) < 5e-3 * scale_) {
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
