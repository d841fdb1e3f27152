#pragma once

#include <span>

#include <Eigen/Core>
#include <Eigen/Geometry>

/// Small changes of rigid transforms and their covariance. A step is a twist (v, w): the shift of a base point, mm, and
/// a rotation vector, rad, both along the axes of the frame that the transform leads to. A covariance of a transform
/// dst_from_src is that of the step, about the origin of src as it lies in dst, in the order x, y, z, rx, ry, rz.
namespace seampath {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Exponential map of so(3): the turn by |w| about w.
Eigen::Quaterniond turn_by(const Eigen::Vector3d& w);

/// The matrix of v -> w x v.
Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& w);

/// T turned by w about the point `about` of its destination, then shifted by v.
Eigen::Isometry3d displaced(const Eigen::Isometry3d& T, const Vector6& step, const Eigen::Vector3d& about);

/// The step, about the origin of `from`, that leads from one transform to the other.
Vector6 displacement(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to);

/// Takes a step about a to the same motion as a step about b.
Matrix6 change_of_reference(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

/// Covariance, mm^2, of where T takes the point q of its source.
Eigen::Matrix3d covariance_at(const Matrix6& covariance, const Eigen::Isometry3d& T, const Eigen::Vector3d& q);

/// The rotation nearest to M.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& M);

/// The rigid motion that takes the points `from` nearest to the points `to` in the least-squares sense (Umeyama, IEEE
/// PAMI 13, 1991, without scale): proper, never a mirror image. One point or more, as many of each.
Eigen::Isometry3d rigid_through(std::span<const Eigen::Vector3d> from, std::span<const Eigen::Vector3d> to);

}  // namespace seampath
