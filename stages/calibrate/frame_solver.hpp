#pragma once

#include <span>
#include <vector>

#include "stages/calibrate/calibrate.hpp"

/// The linear algebra behind calibrate_frame().
namespace seampath::calibrating {

/// Normal equations of a step (v, w) about a base point: H step = g makes the squares of the residuals over their
/// sigmas, whose sum is chi2, least.
struct Sums {
    Matrix6 H = Matrix6::Zero();
    Vector6 g = Vector6::Zero();
    double chi2 = 0;
    int count = 0;
};
Sums& operator+=(Sums& a, const Sums& b);

Sums sums_of(const FrameFeature& feature, const Eigen::Isometry3d& T, const Eigen::Vector3d& about);

/// Where turns count from, and the lever that makes a length of a turn: centroid and rms radius of the points.
struct Reference {
    Eigen::Vector3d about{0, 0, 0};
    double length = 1;
};
Reference reference_of(std::span<const FrameFeature> features);

/// A frame, its covariance, and the directions that nothing holds: orthonormal columns (v, length * w) about the
/// reference, with the share of the mean information that each has, least first.
struct Solution {
    Eigen::Isometry3d T;
    Matrix6 covariance;  ///< of the step about T's origin
    Reference reference;
    Eigen::Matrix<double, 6, Eigen::Dynamic> weak;
    std::vector<double> weak_share;
    double chi2 = 0;
    int count = 0;
    double step_mm = 0;  ///< the last one's length
};

/// Gauss-Newton by level: each level's least squares within what the levels before leave open. Directions with a share
/// below `weak_ratio` are not moved along. `rounds` at most.
Solution solve(std::span<const FrameFeature> features, const Eigen::Isometry3d& start, double weak_ratio, int rounds);

/// How the sums of each level fix the six directions, already scaled to lengths.
struct LevelStep {
    Vector6 step = Vector6::Zero();
    Matrix6 covariance = Matrix6::Zero();
    Eigen::Matrix<double, 6, Eigen::Dynamic> weak;
    std::vector<double> weak_share;
};
LevelStep step_by_level(std::span<const Sums> levels, double length, double weak_ratio);

/// The weak directions by name, in the part frame.
std::vector<Weakness> weaknesses(const Solution& solution);

}  // namespace seampath::calibrating
