#include "stages/geometry/pose.hpp"

#include <algorithm>
#include <cmath>

namespace seampath {

double rotation_angle(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
    // |a - b| = 2 sin(angle / 4) where a and b have the same sign.
    const double apart = std::min((a.coeffs() - b.coeffs()).norm(), (a.coeffs() + b.coeffs()).norm());
    return 4 * std::asin(std::min(1.0, 0.5 * apart));
}

Eigen::Quaterniond nearest_sign(const Eigen::Quaterniond& q, const Eigen::Quaterniond& reference) {
    return q.dot(reference) < 0 ? Eigen::Quaterniond(-q.coeffs()) : q;
}

Eigen::Vector3d rotation_vector(const Eigen::Quaterniond& q) {
    const double sine = q.vec().norm();
    if (sine == 0) {
        return Eigen::Vector3d::Zero();
    }
    const double angle = 2 * std::atan2(sine, std::abs(q.w()));
    return (q.w() < 0 ? -angle : angle) / sine * q.vec();
}

Eigen::Vector3d euler_zyx(const Eigen::Quaterniond& q, double free_z) {
    constexpr double kFree = 1e-12;  // cosine of y below which z is but rounding
    const Eigen::Matrix3d r = q.toRotationMatrix();
    const double z = std::hypot(r(0, 0), r(1, 0)) < kFree ? free_z : std::atan2(r(1, 0), r(0, 0));
    // What is left to y and x when z is taken off has its largest numbers where they are read.
    const Eigen::Matrix3d yx = Eigen::AngleAxisd(-z, Eigen::Vector3d::UnitZ()).toRotationMatrix() * r;
    return {z, std::atan2(-yx(2, 0), std::abs(yx(0, 0))), std::atan2(-yx(1, 2), yx(1, 1))};
}

Eigen::Quaterniond from_euler_zyx(double z, double y, double x) {
    return Eigen::AngleAxisd(z, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(y, Eigen::Vector3d::UnitY()) *
           Eigen::AngleAxisd(x, Eigen::Vector3d::UnitX());
}

double distance_to_segment(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    const Eigen::Vector3d along = b - a;
    const double length2 = along.squaredNorm();
    const double w = length2 > 0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0;
    return (a + w * along - p).norm();
}

}  // namespace seampath
