#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

/// The surfaces that parts are made of. Directions are unit, lengths mm, angles rad. A signed distance is above 0
/// outside the material; the outward normal at p is the direction in which it grows.
namespace seampath {

struct Plane {
    Eigen::Vector3d point;
    Eigen::Vector3d normal;  ///< out of the material
};

struct Cylinder {
    Eigen::Vector3d point;  ///< on the axis
    Eigen::Vector3d axis;
    double radius = 0;
};

/// One nappe: the material is about the axis, ahead of the apex.
struct Cone {
    Eigen::Vector3d apex;
    Eigen::Vector3d axis;   ///< from the apex into the cone
    double half_angle = 0;  ///< 0..pi/2
};

struct Sphere {
    Eigen::Vector3d centre;
    double radius = 0;
};

struct Ellipsoid {
    Eigen::Vector3d centre;
    Eigen::Matrix3d axes;       ///< orthonormal columns
    Eigen::Vector3d semi_axes;  ///< along those columns
};

/// The part of v that is square to a unit axis.
inline Eigen::Vector3d across(const Eigen::Vector3d& v, const Eigen::Vector3d& axis) {
    return v - v.dot(axis) * axis;
}

inline double signed_distance(const Plane& s, const Eigen::Vector3d& p) {
    return s.normal.dot(p - s.point);
}
inline double signed_distance(const Cylinder& s, const Eigen::Vector3d& p) {
    return across(p - s.point, s.axis).norm() - s.radius;
}
inline double signed_distance(const Sphere& s, const Eigen::Vector3d& p) {
    return (p - s.centre).norm() - s.radius;
}
inline double signed_distance(const Cone& s, const Eigen::Vector3d& p) {
    const Eigen::Vector3d w = p - s.apex;
    const double along = w.dot(s.axis), out = across(w, s.axis).norm();
    const double cosine = std::cos(s.half_angle), sine = std::sin(s.half_angle);
    return along * cosine + out * sine < 0 ? w.norm() : out * cosine - along * sine;
}

inline Eigen::Vector3d outward_normal(const Plane& s, const Eigen::Vector3d&) {
    return s.normal;
}
inline Eigen::Vector3d outward_normal(const Cylinder& s, const Eigen::Vector3d& p) {
    return across(p - s.point, s.axis).normalized();
}
inline Eigen::Vector3d outward_normal(const Sphere& s, const Eigen::Vector3d& p) {
    return (p - s.centre).normalized();
}
inline Eigen::Vector3d outward_normal(const Cone& s, const Eigen::Vector3d& p) {
    return std::cos(s.half_angle) * across(p - s.apex, s.axis).normalized() - std::sin(s.half_angle) * s.axis;
}
/// p on the surface, or on one of the same shape about the same centre.
inline Eigen::Vector3d outward_normal(const Ellipsoid& s, const Eigen::Vector3d& p) {
    const Eigen::Vector3d w = s.axes.transpose() * (p - s.centre);
    return (s.axes * (w.array() / s.semi_axes.array().square()).matrix()).normalized();
}

/// f(p) = w' A w + 2 b.w + c with w = p - origin; the surface is f = 0 and f < 0 inside the material.
struct Quadric {
    Eigen::Vector3d origin;
    Eigen::Matrix3d A;
    Eigen::Vector3d b;
    double c = 0;
};

inline Quadric quadric(const Plane& s) {
    return {s.point, Eigen::Matrix3d::Zero(), 0.5 * s.normal, 0};
}
inline Quadric quadric(const Cylinder& s) {
    const Eigen::Matrix3d A = Eigen::Matrix3d::Identity() - s.axis * s.axis.transpose();
    return {s.point, A, Eigen::Vector3d::Zero(), -s.radius * s.radius};
}
/// Both nappes.
inline Quadric quadric(const Cone& s) {
    const double cosine = std::cos(s.half_angle);
    const Eigen::Matrix3d A = cosine * cosine * Eigen::Matrix3d::Identity() - s.axis * s.axis.transpose();
    return {s.apex, A, Eigen::Vector3d::Zero(), 0};
}
inline Quadric quadric(const Sphere& s) {
    return {s.centre, Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero(), -s.radius * s.radius};
}
inline Quadric quadric(const Ellipsoid& s) {
    const Eigen::Vector3d inverse_squares = s.semi_axes.array().square().inverse();
    return {s.centre, s.axes * inverse_squares.asDiagonal() * s.axes.transpose(), Eigen::Vector3d::Zero(), -1};
}

}  // namespace seampath
