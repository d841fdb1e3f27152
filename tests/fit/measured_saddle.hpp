#pragma once

#include <cmath>
#include <cstdint>

#include "datasets/rng.hpp"
#include "stages/fit/fit.hpp"
#include "stages/geometry/bspline.hpp"
#include "tests/papers/saddles.hpp"

/// Saddles measured point by point with noise, and how far the smoothing spline through them is from the truth.
namespace seampath {

/// How the points of a saddle are off.
struct SaddleNoise {
    double sigma = 0.1;            ///< mm: of the distance from the seam, or along each axis
    bool along_each_axis = false;  ///< else across the seam only, as seam points state their sigma
    double off_share = 0;          ///< of points that are off by 2 mm, anywhere to
};

/// 2000 points at equal distances round it.
inline Seam measured_saddle(const SaddleCurve& saddle, const SaddleNoise& noise, std::uint64_t seed) {
    constexpr int kPoints = 2000;
    const Random random(seed, 0);
    Seam seam;
    seam.closed = true;
    for (int i = 0; i < kPoints; ++i) {
        const SaddlePoint at = saddle.at(saddle.theta(saddle.length() * i / kPoints));
        const auto k = 8 * static_cast<std::uint64_t>(i);
        const Eigen::Vector3d normal(random.normal(k), random.normal(k + 1), random.normal(k + 6));
        const Eigen::Vector3d across = (at.n2 - at.n2.dot(at.n1) * at.n1).normalized();
        Eigen::Vector3d p = at.p;
        if (noise.along_each_axis) {
            p += noise.sigma * normal;
        } else {
            p += noise.sigma / std::sqrt(2.0) * (normal.x() * at.n1 + normal.y() * across);
        }
        if (random.uniform(k + 2, 0, 1) < noise.off_share) {
            p += 2 * Eigen::Vector3d(random.normal(k + 3), random.normal(k + 4), random.normal(k + 5)).normalized();
        }
        seam.points.push_back({p, at.n1, at.n2, noise.sigma, false});
    }
    return seam;
}

inline FitOptions spline_model() {
    FitOptions options;
    options.model = FitModel::spline;
    return options;
}

struct SaddleErrors {
    double rms = 0, max = 0;  ///< mm, distance of the true seam from the curve
};

inline SaddleErrors errors_of(const SeamModel& model, const SaddleCurve& saddle) {
    constexpr int kLooks = 400;
    SaddleErrors errors;
    for (int i = 0; i < kLooks; ++i) {
        const SaddlePoint at = saddle.at(saddle.theta(saddle.length() * i / kLooks));
        const double off = (position(model.curve, nearest_parameter(model.curve, at.p)) - at.p).norm();
        errors.rms += off * off / kLooks;
        errors.max = std::max(errors.max, off);
    }
    errors.rms = std::sqrt(errors.rms);
    return errors;
}

}  // namespace seampath
