#include "stages/calibrate/frame_solver.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "stages/error.hpp"

namespace seampath::calibrating {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Basis = Eigen::Matrix<double, 6, Eigen::Dynamic>;

void add_row(Sums& sums, const Vector6& J, double r) {
    sums.H += J * J.transpose();
    sums.g -= r * J;
    sums.chi2 += r * r;
    ++sums.count;
}

// Lengths of all six: a turn by w moves what is `length` away by length * w.
Vector6 scale_of(double length) {
    Vector6 d = Vector6::Ones();
    d.tail<3>() /= length;
    return d;
}

template <class F>
void for_points(std::span<const FrameFeature> features, const F& f) {
    for (const FrameFeature& feature : features) {
        for (const FramePoint& point : feature.points) {
            f(point.measured);
        }
        for (const FrameRow& row : feature.rows) {
            f(row.point);
        }
        for (const FramePose& pose : feature.poses) {
            for (const Vector3d& place : pose.places) {
                f(pose.measured * place);
            }
        }
    }
}

}  // namespace

Sums& operator+=(Sums& a, const Sums& b) {
    a.H += b.H;
    a.g += b.g;
    a.chi2 += b.chi2;
    a.count += b.count;
    return a;
}

Sums sums_of(const FrameFeature& feature, const Isometry3d& T, const Vector3d& about) {
    Sums sums;
    for (const FramePoint& point : feature.points) {
        const Eigen::LLT<Matrix3d> llt(point.covariance);
        ensure(llt.info() == Eigen::Success, "a covariance is positive definite");
        const Vector3d x = T * point.nominal, r = llt.matrixL().solve(point.measured - x);
        Eigen::Matrix<double, 3, 6> J;
        J << -Matrix3d::Identity(), cross_matrix(x - about);
        J = llt.matrixL().solve(J);
        for (int k = 0; k < 3; ++k) {
            add_row(sums, J.row(k).transpose(), r[k]);
        }
    }
    for (const FrameRow& row : feature.rows) {
        const Vector3d m = T.linear() * row.normal;
        const double r = m.dot(row.point - T.translation()) - row.offset_mm;
        Vector6 J;
        J << -m, -(row.point - about).cross(m);
        add_row(sums, J / row.sigma_mm, r / row.sigma_mm);
    }
    for (const FramePose& pose : feature.poses) {
        const Eigen::LLT<Eigen::MatrixXd> llt(pose.covariance);
        ensure(llt.info() == Eigen::Success, "a covariance is positive definite");
        const Isometry3d fitted = T * pose.nominal;
        // A step about `about` shifts what lies elsewhere by its turn, too.
        const Eigen::MatrixXd J = llt.matrixL().solve(change_of_reference(about, fitted.translation()));
        const Eigen::VectorXd r = llt.matrixL().solve(displacement(pose.measured, fitted));
        for (Eigen::Index k = 0; k < 6; ++k) {
            add_row(sums, J.row(k).transpose(), r[k]);
        }
    }
    return sums;
}

Reference reference_of(std::span<const FrameFeature> features) {
    Reference reference;
    double count = 0, squares = 0;
    for_points(features, [&](const Vector3d& p) {
        reference.about += p;
        count += 1;
    });
    reference.about /= count;
    for_points(features, [&](const Vector3d& p) { squares += (p - reference.about).squaredNorm() / count; });
    reference.length = squares > 0 ? std::sqrt(squares) : 1;
    return reference;
}

// With N a basis of what the levels before leave open and U of what this one settles within it, the estimate solves
// U' g = 0 for each level; its covariance follows from how those equations hang on the frame (A = U' H) and on the
// measurements (B = U' H U), the levels being measured independently.
LevelStep step_by_level(std::span<const Sums> levels, double length, double weak_ratio) {
    const Vector6 D = scale_of(length);
    LevelStep result;
    Basis open = Matrix6::Identity();
    Matrix6 A = Matrix6::Zero(), B = Matrix6::Zero();
    double mean = 0;
    Eigen::Index settled = 0;
    Eigen::VectorXd last = Eigen::VectorXd::Zero(6);
    for (const Sums& level : levels) {
        const Matrix6 H = D.asDiagonal() * level.H * D.asDiagonal();
        const double share = H.trace() / 6;
        mean += share;
        // A matrix first, so that one solver is compiled for all.
        const Eigen::MatrixXd left_open = open.transpose() * H * open;
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(left_open);
        const Eigen::Index k = open.cols();
        const auto weak = std::count_if(eigen.eigenvalues().begin(), eigen.eigenvalues().end(),
                                        [&](double value) { return !(value > weak_ratio * share); });
        const Basis U = open * eigen.eigenvectors().rightCols(k - weak);
        const Vector6 left = D.asDiagonal() * level.g - H * result.step;
        result.step += U * (U.transpose() * left).cwiseQuotient(eigen.eigenvalues().tail(k - weak));
        A.middleRows(settled, k - weak) = U.transpose() * H;
        B.block(settled, settled, k - weak, k - weak) = eigen.eigenvalues().tail(k - weak).asDiagonal();
        settled += k - weak;
        last = eigen.eigenvalues().head(weak);
        open = Basis(open * eigen.eigenvectors().leftCols(weak));
        if (open.cols() == 0) {
            break;
        }
    }
    result.weak = open;
    for (Eigen::Index i = 0; i < open.cols(); ++i) {
        result.weak_share.push_back(mean > 0 ? std::max(0.0, last[i] / mean) : 0);
    }
    A.bottomRows(open.cols()) = open.transpose();
    const Matrix6 inverse = A.fullPivLu().inverse();
    result.covariance = D.asDiagonal() * inverse * B * inverse.transpose() * D.asDiagonal();
    result.step = D.asDiagonal() * result.step;
    return result;
}

Solution solve(std::span<const FrameFeature> features, const Isometry3d& start, double weak_ratio, int rounds) {
    int most = 0;
    for (const FrameFeature& feature : features) {
        most = std::max(most, feature.level);
    }
    Solution s{start, Matrix6::Zero(), reference_of(features), {}, {}, 0, 0, 0};
    LevelStep found;
    for (int round = 0; round < rounds; ++round) {
        std::vector<Sums> levels(static_cast<std::size_t>(most) + 1);
        for (const FrameFeature& feature : features) {
            levels[static_cast<std::size_t>(feature.level)] += sums_of(feature, s.T, s.reference.about);
        }
        found = step_by_level(levels, s.reference.length, weak_ratio);
        s.T = displaced(s.T, found.step, s.reference.about);
        s.step_mm = found.step.head<3>().norm() + s.reference.length * found.step.tail<3>().norm();
        if (s.step_mm < 1e-12 * (s.reference.length + s.reference.about.norm())) {
            break;
        }
    }
    const Matrix6 J = change_of_reference(s.reference.about, s.T.translation());
    s.covariance = J * found.covariance * J.transpose();
    s.weak = found.weak;
    s.weak_share = found.weak_share;
    for (const FrameFeature& feature : features) {
        const Sums sums = sums_of(feature, s.T, s.reference.about);
        s.chi2 += sums.chi2;
        s.count += sums.count;
    }
    return s;
}

}  // namespace seampath::calibrating
