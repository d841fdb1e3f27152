#include "stages/geometry/surface_fit.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "stages/geometry/robust_surface.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;
using Points = std::span<const Vector3d>;
using Blocks = std::span<const std::uint32_t>;

constexpr double kCertain = 4;       // sigmas
constexpr double kLeastTurn = 0.02;  // rad, rms, of normals about their mean: below it a curved surface is a plane

template <class S>
SurfaceFit result_of(const detail::RobustSurface<S>& solver, bool bore) {
    return {solver.shape, bore, solver.frame, solver.covariance, solver.scale, solver.share_taken};
}

// 1-sigma of a function of the shape.
template <class S, class Function>
double sigma_of(const detail::RobustSurface<S>& fit, const Function& f) {
    typename detail::RobustSurface<S>::Row gradient, step;
    const double h = 1e-4 * fit.frame.length;
    for (Eigen::Index i = 0; i < gradient.size(); ++i) {
        step.setZero();
        step[i] = h;
        gradient[i] = (f(moved(fit.shape, fit.frame, step)) - f(moved(fit.shape, fit.frame, -step))) / (2 * h);
    }
    return std::sqrt(std::max(0.0, gradient.dot(fit.covariance * gradient)));
}

// The larger principal curvature, of a cone as far from its apex as the origin is.
double curvature(const Cylinder& s, const Vector3d&) {
    return 1 / s.radius;
}
double curvature(const Cone& s, const Vector3d& origin) {
    return std::cos(s.half_angle) / (std::abs((origin - s.apex).dot(s.axis)) * std::tan(s.half_angle));
}
double curvature(const Sphere& s, const Vector3d&) {
    return 1 / s.radius;
}

// A cone without half angle is a cylinder.
template <class S>
bool has_opening(const detail::RobustSurface<S>& fit) {
    if constexpr (std::is_same_v<S, Cone>) {
        return fit.shape.half_angle > kCertain * sigma_of(fit, [](const Cone& s) { return s.half_angle; });
    }
    return true;
}

// Where the outward normal is roughly known.
struct Hints {
    Points places, normals;
    bool turn() const {
        return places.size() >= 3 && places.size() == normals.size() &&
               detail::scatter_of(normals, detail::mean_of(normals)).trace() > kLeastTurn * kLeastTurn;
    }
};

// Begins at a curved surface.
template <class S>
std::optional<SurfaceFit> settled(const std::optional<S>& start, Points points, Blocks block, const Hints& hints,
                                  double least_scale) {
    if (!start) {
        return std::nullopt;
    }
    detail::RobustSurface<S> solver(*start, points, least_scale);
    if (!solver.fit(block)) {
        return std::nullopt;
    }
    const auto bend = [&](const S& s) { return curvature(s, solver.frame.origin); };
    const double k = bend(solver.shape);
    const bool is_curved = k > kCertain * sigma_of(solver, bend), is_noise = 1 / k < kCertain * solver.scale;
    if (!is_curved || is_noise || !has_opening(solver)) {
        return std::nullopt;
    }
    double outwards = 0;
    for (std::size_t i = 0; i < hints.places.size(); ++i) {
        outwards += outward_normal(solver.shape, hints.places[i]).dot(hints.normals[i]);
    }
    return result_of(solver, outwards < 0);
}

// Linear least squares of y over rows of N numbers.
template <int N>
struct LinearFit {
    Eigen::Matrix<double, N, N> A = Eigen::Matrix<double, N, N>::Zero();
    Eigen::Matrix<double, N, 1> b = Eigen::Matrix<double, N, 1>::Zero();

    void add(const Eigen::Matrix<double, N, 1>& x, double y) {
        A += x * x.transpose();
        b += x * y;
    }
    Eigen::Matrix<double, N, 1> solve() const { return A.ldlt().solve(b); }
};

// The starts are algebraic (Kasa 1976): of a circle |q|^2 = 2 c.q + (r^2 - |c|^2), linear in what is asked. Biased, but
// close.
std::optional<Cylinder> cylinder_along(Points points, const Vector3d& axis) {
    const Vector3d e0 = axis.unitOrthogonal(), e1 = axis.cross(e0), centroid = detail::mean_of(points);
    LinearFit<3> circle;
    for (const auto& p : points) {
        const Vector3d v = p - centroid, q(v.dot(e0), v.dot(e1), 0);
        circle.add(q + Vector3d::UnitZ(), q.squaredNorm());
    }
    const Vector3d c = circle.solve();
    const double squared = c.head<2>().squaredNorm() / 4 + c[2];
    if (!(squared > 0) || !std::isfinite(squared)) {
        return std::nullopt;
    }
    return Cylinder{centroid + 0.5 * (c[0] * e0 + c[1] * e1), axis, std::sqrt(squared)};
}

std::optional<Sphere> sphere_through(Points points) {
    const Vector3d centroid = detail::mean_of(points);
    LinearFit<4> sphere;
    for (const auto& p : points) {
        const Vector3d v = p - centroid;
        sphere.add((Eigen::Vector4d() << v, 1).finished(), v.squaredNorm());
    }
    const Eigen::Vector4d c = sphere.solve();
    const double squared = c.head<3>().squaredNorm() / 4 + c[3];
    if (!(squared > 0) || !std::isfinite(squared)) {
        return std::nullopt;
    }
    return Sphere{centroid + 0.5 * c.head<3>(), std::sqrt(squared)};
}

// With h along the axis, of a given half angle: |q|^2 - tan^2 h^2 = 2 c.q - 2 tan^2 h0 h + const, h0 that of the apex.
std::optional<Cone> cone_along(Points points, const Vector3d& axis, double half_angle) {
    const Vector3d e0 = axis.unitOrthogonal(), e1 = axis.cross(e0), centroid = detail::mean_of(points);
    const double slope = std::tan(half_angle) * std::tan(half_angle);
    LinearFit<4> cone;
    for (const auto& p : points) {
        const Vector3d v = p - centroid;
        const Eigen::Vector4d x(v.dot(e0), v.dot(e1), v.dot(axis), 1);
        cone.add(x, x.head<2>().squaredNorm() - slope * x[2] * x[2]);
    }
    const Eigen::Vector4d c = cone.solve();
    const double apex = -c[2] / (2 * slope);
    if (!std::isfinite(apex)) {
        return std::nullopt;
    }
    return Cone{centroid + 0.5 * (c[0] * e0 + c[1] * e1) + apex * axis, apex < 0 ? axis : Vector3d(-axis), half_angle};
}

Vector3d least_direction(const Eigen::Matrix3d& scatter) {
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0);
}

}  // namespace

double SurfaceFit::distance(const Vector3d& p) const {
    return side_ * std::visit([&](const auto& s) { return signed_distance(s, p); }, shape_);
}

Vector3d SurfaceFit::normal(const Vector3d& p) const {
    return side_ * std::visit([&](const auto& s) { return outward_normal(s, p); }, shape_);
}

double SurfaceFit::weight(const Vector3d& p) const {
    return detail::tukey_weight(distance(p) / (detail::kTukey * scale_));
}

SurfaceFit::Vector SurfaceFit::row(const Vector3d& p) const {
    return std::visit([&](const auto& s) -> Vector { return seampath::row(s, frame_, p).by; }, shape_);
}

double SurfaceFit::sigma(const Vector3d& p) const {
    const Vector r = row(p);
    return std::sqrt(std::max(0.0, r.dot(covariance_ * r)));
}

SurfaceFit::Shape SurfaceFit::moved(const Vector& step) const {
    return std::visit([&](const auto& s) -> Shape { return seampath::moved(s, frame_, step); }, shape_);
}

std::optional<SurfaceFit> fit_plane(Points points, Blocks block, const Vector3d& outward, double least_scale) {
    if (points.empty()) {
        return std::nullopt;
    }
    const Vector3d centroid = detail::mean_of(points);
    const Eigen::Matrix3d scatter = detail::scatter_of(points, centroid);
    const Vector3d n = least_direction(scatter);
    detail::RobustSurface<Plane> solver({centroid, n.dot(outward) < 0 ? Vector3d(-n) : n}, points, least_scale);
    if (!solver.fit(block)) {
        return std::nullopt;
    }
    // Across a line of points there is nothing but their noise.
    const double width = std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvalues()[1]);
    return width > kCertain * solver.scale ? std::optional(result_of(solver, false)) : std::nullopt;
}

std::optional<SurfaceFit> fit_cylinder(Points points, Blocks block, Points places, Points normals, double least_scale) {
    const Hints hints{places, normals};
    if (points.empty() || !hints.turn()) {
        return std::nullopt;
    }
    const Vector3d axis = least_direction(detail::scatter_of(normals, Vector3d::Zero()));
    return settled(cylinder_along(points, axis), points, block, hints, least_scale);
}

std::optional<SurfaceFit> fit_cone(Points points, Blocks block, Points places, Points normals, double least_scale) {
    const Hints hints{places, normals};
    if (points.empty() || !hints.turn()) {
        return std::nullopt;
    }
    const Vector3d mean = detail::mean_of(normals), axis = least_direction(detail::scatter_of(normals, mean));
    const double half_angle = std::asin(std::min(1.0, std::abs(mean.dot(axis))));
    return settled(cone_along(points, axis, half_angle), points, block, hints, least_scale);
}

std::optional<SurfaceFit> fit_sphere(Points points, Blocks block, Points places, Points normals, double least_scale) {
    const Hints hints{places, normals};
    if (points.empty() || !hints.turn()) {
        return std::nullopt;
    }
    return settled(sphere_through(points), points, block, hints, least_scale);
}

}  // namespace seampath
