#include "stages/geometry/rigid.hpp"

#include <Eigen/SVD>

#include "stages/error.hpp"
#include "stages/geometry/pose.hpp"

namespace seampath {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

Quaterniond turn_by(const Vector3d& w) {
    const double half = 0.5 * w.norm();
    // sin(x) / x is 1 to rounding below.
    const double share = half > 1e-9 ? 0.5 * std::sin(half) / half : 0.5;
    const Vector3d v = share * w;
    return Quaterniond(std::cos(half), v.x(), v.y(), v.z()).normalized();
}

Matrix3d cross_matrix(const Vector3d& w) {
    Matrix3d m;
    m << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
    return m;
}

Isometry3d displaced(const Isometry3d& T, const Vector6& step, const Vector3d& about) {
    const Quaterniond turn = turn_by(step.tail<3>());
    Isometry3d moved = Isometry3d::Identity();
    moved.linear() = (turn * Quaterniond(T.linear())).normalized().toRotationMatrix();
    moved.translation() = about + turn * (T.translation() - about) + step.head<3>();
    return moved;
}

Vector6 displacement(const Isometry3d& from, const Isometry3d& to) {
    const Quaterniond turn = Quaterniond(to.linear()) * Quaterniond(from.linear()).conjugate();
    Vector6 step;
    step << to.translation() - from.translation(), rotation_vector(turn.normalized());
    return step;
}

Matrix6 change_of_reference(const Vector3d& a, const Vector3d& b) {
    Matrix6 J = Matrix6::Identity();
    J.topRightCorner<3, 3>() = -cross_matrix(b - a);
    return J;
}

Matrix3d covariance_at(const Matrix6& covariance, const Isometry3d& T, const Vector3d& q) {
    Eigen::Matrix<double, 3, 6> J;
    J << Matrix3d::Identity(), -cross_matrix(T.linear() * q);
    return J * covariance * J.transpose();
}

Matrix3d nearest_rotation(const Matrix3d& M) {
    const Eigen::JacobiSVD<Matrix3d> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Matrix3d U = svd.matrixU();
    if ((U * svd.matrixV().transpose()).determinant() < 0) {
        U.col(2) *= -1;
    }
    return U * svd.matrixV().transpose();
}

Isometry3d rigid_through(std::span<const Vector3d> from, std::span<const Vector3d> to) {
    ensure(!from.empty() && from.size() == to.size(), "as many points of each");
    Vector3d a = Vector3d::Zero(), b = Vector3d::Zero();
    for (std::size_t i = 0; i < from.size(); ++i) {
        a += from[i] / static_cast<double>(from.size());
        b += to[i] / static_cast<double>(from.size());
    }
    Matrix3d M = Matrix3d::Zero();
    for (std::size_t i = 0; i < from.size(); ++i) {
        M += (to[i] - b) * (from[i] - a).transpose();
    }
    Isometry3d T = Isometry3d::Identity();
    T.linear() = nearest_rotation(M);
    T.translation() = b - T.linear() * a;
    return T;
}

}  // namespace seampath
