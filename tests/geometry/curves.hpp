#pragma once

#include <cmath>
#include <numbers>

#include <Eigen/Core>

#include "stages/geometry/bspline.hpp"

/// Splines and seams of known shape.
namespace seampath {

inline constexpr double kPi = std::numbers::pi;

/// An open spline with uneven knots that bends and twists.
inline CubicBSpline open_spline() {
    CubicBSpline curve;
    curve.knots = {0, 0, 0, 0, 7, 20, 22, 40, 55, 55, 55, 55};
    curve.control = {{0, 0, 0}, {3, 4, 1}, {9, 8, -2}, {18, 2, 3}, {27, -6, 5}, {35, 1, 0}, {44, 7, -4}, {50, 3, 2}};
    return curve;
}

/// A closed one.
inline CubicBSpline closed_spline() {
    CubicBSpline curve;
    curve.periodic = true;
    curve.knots = {0, 6, 15, 21, 33, 40, 52};
    curve.control = {{10, 0, 0}, {6, 9, 2}, {-5, 8, -1}, {-11, -1, 1}, {-4, -9, 3}, {7, -8, -2}};
    return curve;
}

/// The periodic spline over evenly spaced points of a circle: off it by less than radius * (2 pi / spans)^4 / 500.
inline CubicBSpline circle_spline(double radius, int spans) {
    CubicBSpline curve;
    curve.periodic = true;
    const double step = 2 * kPi / spans;
    // At a knot the spline is (a + 4 b + c) / 6: a radius that makes this `radius`.
    const double r = 6 * radius / (4 + 2 * std::cos(step));
    for (int i = 0; i < spans; ++i) {
        curve.control.emplace_back(r * std::cos(i * step), r * std::sin(i * step), 0);
    }
    for (int i = 0; i <= spans; ++i) {
        curve.knots.push_back(i * radius * step);
    }
    return curve;
}

/// Ordered points of a shape with the flanks of a fillet: the plane z = 0 and an upright wall along the curve.
template <class Curve>
Seam seam_along(const Curve& curve, int points, bool closed, double sigma = 0.01) {
    Seam seam;
    seam.closed = closed;
    for (int i = 0; i < points; ++i) {
        const double x = static_cast<double>(i) / (closed ? points : points - 1);
        const Eigen::Vector3d ahead = curve(x + 1e-6) - curve(x - 1e-6);
        const Eigen::Vector3d wall = Eigen::Vector3d(ahead.y(), -ahead.x(), 0).normalized();
        seam.points.push_back({curve(x), wall, Eigen::Vector3d::UnitZ(), sigma, false});
        if (wall.cross(Eigen::Vector3d::UnitZ()).dot(ahead) < 0) {
            std::swap(seam.points.back().n1, seam.points.back().n2);
        }
    }
    return seam;
}

struct CircleCurve {
    double radius;
    Eigen::Vector3d operator()(double x) const {
        return {radius * std::cos(2 * kPi * x), radius * std::sin(2 * kPi * x), 0};
    }
};

struct Helix {
    double radius, pitch, turns;
    Eigen::Vector3d operator()(double x) const {
        const double a = 2 * kPi * turns * x;
        return {radius * std::cos(a), radius * std::sin(a), pitch * turns * x};
    }
    double length() const { return turns * std::hypot(2 * kPi * radius, pitch); }
};

struct Straight {
    Eigen::Vector3d from, to;
    Eigen::Vector3d operator()(double x) const { return from + x * (to - from); }
};

struct SineCurve {
    double length, amplitude;
    Eigen::Vector3d operator()(double x) const { return {length * x, amplitude * std::sin(2 * kPi * x), 0}; }
};

/// Distance of p from a shape by brute force over its parameter, refined.
template <class Curve>
double distance_to(const Curve& curve, const Eigen::Vector3d& p) {
    constexpr int kSamples = 4000;
    double best = 0;
    for (int i = 1; i <= kSamples; ++i) {
        const double x = static_cast<double>(i) / kSamples;
        best = (curve(x) - p).squaredNorm() < (curve(best) - p).squaredNorm() ? x : best;
    }
    for (double step = 1.0 / kSamples; step > 1e-12; step /= 2) {
        for (const double x : {std::max(0.0, best - step), std::min(1.0, best + step)}) {
            best = (curve(x) - p).squaredNorm() < (curve(best) - p).squaredNorm() ? x : best;
        }
    }
    return (curve(best) - p).norm();
}

}  // namespace seampath
