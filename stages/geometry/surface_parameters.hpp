#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Core>

#include "stages/geometry/quadric.hpp"

/// The parameters of a surface, none redundant, as steps from where it is: a plane's 3, a cylinder's 5, a cone's 6, a
/// sphere's 4. All are lengths, of the order of what they move the surface by near `origin`, so that those of a short
/// piece of a large surface are told apart as well as they can be.
namespace seampath {

/// What the steps of a surface count from.
struct SurfaceFrame {
    Eigen::Vector3d origin;  ///< near the points
    double length = 1;       ///< lever that makes a length of a turn, mm
    Eigen::Vector3d e0, e1;  ///< square to the plane's normal, or to the axis
};

/// Signed distance of a point and its derivatives by the steps, in the order in which `moved` takes them.
template <int N>
struct SurfaceRow {
    double distance;
    Eigen::Matrix<double, N, 1> by;
};

namespace detail {

inline SurfaceFrame frame_along(const Eigen::Vector3d& axis, const Eigen::Vector3d& origin, double length) {
    const Eigen::Vector3d e0 = axis.unitOrthogonal();
    return {origin, length, e0, axis.cross(e0)};
}

inline Eigen::Vector3d turned(const Eigen::Vector3d& axis, double s0, double s1, const SurfaceFrame& f) {
    return (axis + (s0 * f.e0 + s1 * f.e1) / f.length).normalized();
}

// Of a point on the axis or centre there is no direction outwards: its derivatives by shifts are 0.
inline double nonzero(double out) {
    return std::max(out, std::numeric_limits<double>::min());
}

}  // namespace detail

// Plane: along its normal; two turns.
inline SurfaceFrame frame_of(const Plane& s, const Eigen::Vector3d& origin, double length) {
    return detail::frame_along(s.normal, origin, length);
}
inline SurfaceRow<3> row(const Plane& s, const SurfaceFrame& f, const Eigen::Vector3d& p) {
    const Eigen::Vector3d v = p - f.origin;
    return {signed_distance(s, p), {-1, v.dot(f.e0) / f.length, v.dot(f.e1) / f.length}};
}
inline Plane moved(const Plane& s, const SurfaceFrame& f, const Eigen::Vector3d& step) {
    const Eigen::Vector3d foot = f.origin - signed_distance(s, f.origin) * s.normal;
    return {foot + step[0] * s.normal, detail::turned(s.normal, step[1], step[2], f)};
}

// Cylinder: two shifts of the axis; two turns of it about the foot of the origin; the radius.
inline SurfaceFrame frame_of(const Cylinder& s, const Eigen::Vector3d& origin, double length) {
    return detail::frame_along(s.axis, origin, length);
}
inline SurfaceRow<5> row(const Cylinder& s, const SurfaceFrame& f, const Eigen::Vector3d& p) {
    const Eigen::Vector3d w = across(p - s.point, s.axis);
    const double out = w.norm(), a = -w.dot(f.e0) / detail::nonzero(out), b = -w.dot(f.e1) / detail::nonzero(out);
    const double h = (p - f.origin).dot(s.axis) / f.length;
    SurfaceRow<5> r{out - s.radius, {}};
    r.by << a, b, a * h, b * h, -1;
    return r;
}
inline Cylinder moved(const Cylinder& s, const SurfaceFrame& f, const Eigen::Matrix<double, 5, 1>& step) {
    const Eigen::Vector3d foot = s.point + (f.origin - s.point).dot(s.axis) * s.axis;
    return {foot + step[0] * f.e0 + step[1] * f.e1, detail::turned(s.axis, step[2], step[3], f), s.radius + step[4]};
}

// Sphere: three shifts of the centre; the radius.
inline SurfaceFrame frame_of(const Sphere&, const Eigen::Vector3d& origin, double length) {
    return {origin, length, Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY()};
}
inline SurfaceRow<4> row(const Sphere& s, const SurfaceFrame&, const Eigen::Vector3d& p) {
    const Eigen::Vector3d w = p - s.centre;
    const double out = w.norm();
    SurfaceRow<4> r{out - s.radius, {}};
    r.by << -w / detail::nonzero(out), -1;
    return r;
}
inline Sphere moved(const Sphere& s, const SurfaceFrame&, const Eigen::Vector4d& step) {
    return {s.centre + step.head<3>(), s.radius + step[3]};
}

// Cone: two shifts of the axis; two turns of it about the foot of the origin; the half angle, which turns the generator
// lines about where they pass the origin; its place along the generators' normals. With h along and `out` off the axis
// from that foot, s the foot's distance from the cone and tau a place along a generator:
//     d = out cos(alpha) - h sin(alpha) - s,  tau = out sin(alpha) + h cos(alpha).
inline SurfaceFrame frame_of(const Cone& s, const Eigen::Vector3d& origin, double length) {
    return detail::frame_along(s.axis, origin, length);
}
inline SurfaceRow<6> row(const Cone& s, const SurfaceFrame& f, const Eigen::Vector3d& p) {
    const double cosine = std::cos(s.half_angle), sine = std::sin(s.half_angle);
    const Eigen::Vector3d from_apex = p - s.apex, w = across(from_apex, s.axis), v = f.origin - s.apex;
    const double out = w.norm(), along = from_apex.dot(s.axis), foot = v.dot(s.axis);
    const double a = -w.dot(f.e0) / detail::nonzero(out), b = -w.dot(f.e1) / detail::nonzero(out);
    const double tau = out * sine + (along - foot) * cosine;
    const double turn = (tau - across(v, s.axis).norm() * sine) / f.length;
    SurfaceRow<6> r{out * cosine - along * sine, {}};
    r.by << a * cosine, b * cosine, a * tau / f.length, b * tau / f.length, -turn, -1;
    return r;
}
inline Cone moved(const Cone& s, const SurfaceFrame& f, const Eigen::Matrix<double, 6, 1>& step) {
    const Eigen::Vector3d v = f.origin - s.apex;
    const double cosine = std::cos(s.half_angle), sine = std::sin(s.half_angle), turn = step[4] / f.length;
    const double foot = v.dot(s.axis), tau = across(v, s.axis).norm() * sine;
    const Eigen::Vector3d axis = detail::turned(s.axis, step[2], step[3], f);
    const double half_angle = s.half_angle + turn;
    // The cosines turn with the generators, so that a step of any length keeps the point at tau in its place.
    const double out = tau * sine + foot * sine * cosine, h = tau * cosine - foot * sine * sine;
    const double distance = out * std::cos(half_angle) - h * std::sin(half_angle) + step[5];
    return {s.apex + foot * s.axis + step[0] * f.e0 + step[1] * f.e1 - distance / std::sin(half_angle) * axis, axis,
            half_angle};
}

}  // namespace seampath
