// The smoothing spline through 2000 points of a saddle, with 5 % of them off by 2 mm: distance of the true seam from it
// and time. Sigma is .1 mm of the distance from the seam, as seam points state it, or along each axis. With --check the
// exit status is 1 when a target is missed; targets are held by the first kind.
//
// Along each axis no choice of stiffness holds the small saddle's target with the third derivative penalised: below the
// table stands the least expected rms, of the stiffness that only the truth could choose.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <numbers>
#include <vector>

#include "tests/fit/measured_saddle.hpp"

namespace {

using namespace seampath;

constexpr int kSeeds = 40, kRepeats = 5;

struct Target {
    double branch_mm, rms_mm, max_mm, ms;
};
constexpr Target kTargets[] = {{150, 0.012, 0.030, 10}, {588, 0.035, 0.2, 1e3}};

struct FitRow {
    double rms = 0, worst_rms = 0, max = 0, ms = 0;
};

/// The least expected rms, mm, of a smoothing spline whose penalty is the integral of the squared derivative of that
/// order: it keeps 1 / (1 + lambda k^(2 order)) of harmonic k of signal and noise (Wahba 1990, 2.1), with the lambda
/// that makes the sum of bias across the seam and noise along two axes least.
double least_rms(const SaddleCurve& saddle, int order) {
    constexpr int kSamples = 2048, kHarmonics = 400, kPoints = 2000;
    constexpr double kSigma = 0.1;
    using Eigen::Matrix3Xd;
    Matrix3Xd p(3, kSamples);
    for (int j = 0; j < kSamples; ++j) {
        p.col(j) = saddle.at(saddle.theta(saddle.length() * j / kSamples)).p;
    }
    const auto turn = [](int j, int k) { return 2 * std::numbers::pi * ((j * k) % kSamples) / kSamples; };
    Eigen::MatrixXd wave(kSamples, 2 * kHarmonics);  // cosine and sine of each harmonic, of mean square 1
    for (int j = 0; j < kSamples; ++j) {
        for (int k = 1; k <= kHarmonics; ++k) {
            wave(j, 2 * k - 2) = std::sqrt(2) * std::cos(turn(j, k));
            wave(j, 2 * k - 1) = std::sqrt(2) * std::sin(turn(j, k));
        }
    }
    const Eigen::MatrixXd share = p * wave / kSamples;
    double least = std::numeric_limits<double>::infinity();
    for (double log_lambda = -36; log_lambda < 0; log_lambda += 0.1) {
        double noise = 1;
        Eigen::VectorXd lost(2 * kHarmonics);
        for (int k = 1; k <= kHarmonics; ++k) {
            const double kept = 1 / (1 + std::pow(10, log_lambda) * std::pow(k, 2 * order));
            lost[2 * k - 2] = lost[2 * k - 1] = 1 - kept;
            noise += 2 * kept * kept;
        }
        const Matrix3Xd off = share * lost.asDiagonal() * wave.transpose();
        double bias = 0;
        for (int j = 0; j < kSamples; ++j) {
            const Eigen::Vector3d along = (p.col((j + 1) % kSamples) - p.col(j)).normalized();
            bias += (off.col(j).squaredNorm() - std::pow(off.col(j).dot(along), 2)) / kSamples;
        }
        least = std::min(least, std::sqrt(bias + 2 * kSigma * kSigma * noise / kPoints));
    }
    return least;
}

/// rms over all seeds, the worst seed's, the largest distance; of the times the median over seeds, each the best of
/// several, for a busy machine only adds.
FitRow measure(const SaddleCurve& saddle, const SaddleNoise& noise) {
    FitRow row;
    std::vector<double> ms;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        const Seam seam = measured_saddle(saddle, noise, seed);
        SeamModel model;
        double best = std::numeric_limits<double>::infinity();
        for (int k = 0; k < kRepeats; ++k) {
            const auto start = std::chrono::steady_clock::now();
            model = fit(seam, {}, spline_model());
            const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
            best = std::min(best, took.count());
        }
        ms.push_back(best);
        const SaddleErrors errors = errors_of(model, saddle);
        row.rms += errors.rms * errors.rms / kSeeds;
        row.worst_rms = std::max(row.worst_rms, errors.rms);
        row.max = std::max(row.max, errors.max);
    }
    std::nth_element(ms.begin(), ms.begin() + kSeeds / 2, ms.end());
    row.ms = ms[kSeeds / 2];
    row.rms = std::sqrt(row.rms);
    return row;
}

}  // namespace

int main(int argc, char** argv) {
    const bool check = argc > 1 && std::strcmp(argv[1], "--check") == 0;
    bool holds = true;
    std::printf("r in 600 mm  sigma .1 mm      rms mm  worst seed  max mm    ms\n");
    for (const Target& target : kTargets) {
        const SaddleCurve saddle = pipes(600, target.branch_mm);
        for (const bool along_each_axis : {false, true}) {
            const FitRow row = measure(saddle, {.along_each_axis = along_each_axis, .off_share = 0.05});
            std::printf("%11g  %-14s  %7.4f  %10.4f  %6.4f  %4.1f\n", target.branch_mm,
                        along_each_axis ? "along an axis" : "of distance", row.rms, row.worst_rms, row.max, row.ms);
            holds = holds && (along_each_axis || (row.worst_rms <= target.rms_mm && row.max <= target.max_mm)) &&
                    row.ms <= target.ms;
        }
    }
    std::printf("least expected rms, sigma along an axis, derivative 3, 4, 6 penalised\n");
    for (const Target& target : kTargets) {
        const SaddleCurve saddle = pipes(600, target.branch_mm);
        std::printf("%11g  %7.4f %7.4f %7.4f\n", target.branch_mm, least_rms(saddle, 3), least_rms(saddle, 4),
                    least_rms(saddle, 6));
    }
    return check && !holds ? 1 : 0;
}
