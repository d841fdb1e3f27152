#include "stages/geometry/least_squares.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Dense>

#include "stages/error.hpp"
#include "stages/geometry/surface_parameters.hpp"

namespace seampath {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Points = std::span<const Vector3d>;

// An eigenvalue or pivot below this share of the largest is rounding.
constexpr double kNothing = 1e-13;
constexpr double kWeak = 1e-9;  // the same of lengths
constexpr int kMostRounds = 200;

[[noreturn]] void undetermined(const std::string& who, std::size_t points, const std::string& what) {
    throw InputError(who + ": " + std::to_string(points) + " points do not determine " + what +
                     "; measure more of it, or further apart");
}

// The points from their centroid: what is fitted loses no digits to a part that lies far from the origin.
struct Centred {
    Vector3d centroid = Vector3d::Zero();
    std::vector<Vector3d> v;
    double length = 0;  // rms distance

    explicit Centred(Points points) : v(points.begin(), points.end()) {
        // Twice: the first mean of numbers far from 0 carries their rounding.
        for (int round = 0; round < 2; ++round) {
            Vector3d mean = Vector3d::Zero();
            for (const auto& x : v) {
                mean += x / static_cast<double>(v.size());
            }
            for (auto& x : v) {
                x -= mean;
            }
            centroid += mean;
        }
        for (const auto& x : v) {
            length += x.squaredNorm() / static_cast<double>(v.size());
        }
        length = std::sqrt(length);
    }

    // Principal directions and mean squares along them, least first.
    Eigen::SelfAdjointEigenSolver<Matrix3d> axes() const {
        Matrix3d scatter = Matrix3d::Zero();
        for (const auto& x : v) {
            scatter += x * x.transpose() / static_cast<double>(v.size());
        }
        return Eigen::SelfAdjointEigenSolver<Matrix3d>(scatter);
    }
};

Vector3d with_sign(const Vector3d& d) {
    Eigen::Index largest = 0;
    d.cwiseAbs().maxCoeff(&largest);
    return d[largest] < 0 ? Vector3d(-d) : d;
}

template <class S, class Distance>
Associated<S> associated(const S& shape, Points points, const Distance& distance) {
    Associated<S> result{shape};
    for (const auto& p : points) {
        const double d = distance(p);
        result.rms += d * d / static_cast<double>(points.size());
        result.largest = std::max(result.largest, std::abs(d));
    }
    result.rms = std::sqrt(result.rms);
    return result;
}

// Signed distances of one point, R of them, and their derivatives by the N parameters, all lengths.
template <int R, int N>
struct Rows {
    Eigen::Matrix<double, R, 1> distance;
    Eigen::Matrix<double, R, N> by;
};

// Gauss-Newton with halved steps where the sum of squares does not fall. `linearise(shape, p)` gives Rows, `move(shape,
// step)` the moved shape. Ends when a step is rounding; false when the points do not determine the parameters.
template <int R, int N, class S, class Linearise, class Move>
bool gauss_newton(S& shape, Points points, double length, const Linearise& linearise, const Move& move) {
    const auto squares = [&](const S& s) {
        double sum = 0;
        for (const auto& p : points) {
            sum += linearise(s, p).distance.squaredNorm();
        }
        return sum;
    };
    const auto rows = static_cast<Eigen::Index>(R * points.size());
    // Of dynamic size, for one decomposition instead of four in the compiled program.
    Eigen::MatrixXd J(rows, N);
    Eigen::VectorXd d(rows);
    double before = squares(shape);
    for (int round = 0; round < kMostRounds; ++round) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Rows<R, N> row = linearise(shape, points[i]);
            J.template middleRows<R>(static_cast<Eigen::Index>(R * i)) = row.by;
            d.template segment<R>(static_cast<Eigen::Index>(R * i)) = row.distance;
        }
        const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(J);
        const auto pivots = qr.matrixR().diagonal().cwiseAbs();
        if (rows < N || !(pivots[N - 1] > kWeak * pivots[0])) {
            return false;
        }
        Eigen::Matrix<double, N, 1> step = qr.solve(-d);
        S next = move(shape, step);
        double after = squares(next);
        for (int halving = 0; halving < 30 && !(after <= before * (1 + 1e-12)); ++halving) {
            step *= 0.5;
            next = move(shape, step);
            after = squares(next);
        }
        shape = next;
        before = after;
        if (!(step.norm() > 1e-13 * length)) {
            return true;
        }
    }
    return true;  // rounding keeps it moving
}

// A surface whose parameters stages/geometry/surface_parameters.hpp names.
template <int N, class S>
bool settle(S& shape, Points points, const Centred& c) {
    const auto linearise = [&](const S& s, const Vector3d& p) {
        const SurfaceRow<N> r = row(s, frame_of(s, c.centroid, c.length), p);
        return Rows<1, N>{Eigen::Matrix<double, 1, 1>(r.distance), r.by.transpose()};
    };
    return gauss_newton<1, N>(shape, points, c.length, linearise,
                              [&](const S& s, const Eigen::Matrix<double, N, 1>& x) {
                                  return moved(s, frame_of(s, c.centroid, c.length), x);
                              });
}

// Linear start of a circle or sphere of D dimensions (Kasa 1976): |q|^2 = 2 c.q + (r^2 - |c|^2).
template <int D>
Eigen::Matrix<double, D + 1, 1> kasa(const std::vector<Eigen::Matrix<double, D, 1>>& q) {
    Eigen::Matrix<double, D + 1, D + 1> A = Eigen::Matrix<double, D + 1, D + 1>::Zero();
    Eigen::Matrix<double, D + 1, 1> b = Eigen::Matrix<double, D + 1, 1>::Zero();
    for (const auto& x : q) {
        Eigen::Matrix<double, D + 1, 1> row;
        row << 2 * x, 1;
        A += row * row.transpose();
        b += row * x.squaredNorm();
    }
    Eigen::Matrix<double, D + 1, 1> c = A.ldlt().solve(b);
    c[D] = std::sqrt(c[D] + c.template head<D>().squaredNorm());
    return c;
}

}  // namespace

Associated<Plane> associated_plane(Points points, const std::string& who) {
    const Centred c(points);
    if (points.size() < 3) {
        undetermined(who, points.size(), "a plane");
    }
    const auto axes = c.axes();
    if (!(axes.eigenvalues()[1] > kNothing * axes.eigenvalues()[2])) {
        undetermined(who, points.size(), "a plane: they lie on one line");
    }
    const Plane plane{c.centroid, with_sign(axes.eigenvectors().col(0))};
    return associated(plane, points, [&](const Vector3d& p) { return signed_distance(plane, p); });
}

Associated<Line> associated_line(Points points, const std::string& who) {
    const Centred c(points);
    if (points.size() < 2 || !(c.length > 0)) {
        undetermined(who, points.size(), "a line");
    }
    const Line line{c.centroid, with_sign(c.axes().eigenvectors().col(2))};
    return associated(line, points, [&](const Vector3d& p) { return across(p - line.point, line.direction).norm(); });
}

namespace {

// The distance from a circle has two parts: within its plane, and along its normal.
Rows<2, 6> rows_of(const Circle& s, const SurfaceFrame& f, const Vector3d& p) {
    const Vector3d w = p - s.centre, flat = across(w, s.normal);
    const double h = w.dot(s.normal), out = flat.norm();
    const double a = flat.dot(f.e0) / detail::nonzero(out), b = flat.dot(f.e1) / detail::nonzero(out);
    Rows<2, 6> r;
    r.distance << out - s.radius, h;
    r.by.row(0) << -a, -b, 0, -h * a / f.length, -h * b / f.length, -1;
    r.by.row(1) << 0, 0, -1, w.dot(f.e0) / f.length, w.dot(f.e1) / f.length, 0;
    return r;
}

Circle moved_circle(const Circle& s, const SurfaceFrame& f, const Eigen::Matrix<double, 6, 1>& step) {
    return {s.centre + step[0] * f.e0 + step[1] * f.e1 + step[2] * s.normal,
            detail::turned(s.normal, step[3], step[4], f), s.radius + step[5]};
}

// Circle through the points as they lie along e0 and e1: its centre there, and its radius.
Vector3d flat_circle(const Centred& c, const Vector3d& e0, const Vector3d& e1) {
    std::vector<Eigen::Vector2d> q;
    for (const auto& v : c.v) {
        q.emplace_back(v.dot(e0), v.dot(e1));
    }
    return kasa<2>(q);
}

}  // namespace

Associated<Circle> associated_circle(Points points, const std::string& who) {
    const Centred c(points);
    if (points.size() < 3) {
        undetermined(who, points.size(), "a circle");
    }
    const Vector3d normal = with_sign(c.axes().eigenvectors().col(0));
    const SurfaceFrame start = detail::frame_along(normal, c.centroid, c.length);
    const Vector3d flat = flat_circle(c, start.e0, start.e1);
    Circle circle{c.centroid + flat[0] * start.e0 + flat[1] * start.e1, normal, flat[2]};
    const auto frame = [&](const Circle& s) { return detail::frame_along(s.normal, s.centre, c.length); };
    const bool found =
        flat.allFinite() &&
        gauss_newton<2, 6>(
            circle, points, c.length, [&](const Circle& s, const Vector3d& p) { return rows_of(s, frame(s), p); },
            [&](const Circle& s, const Eigen::Matrix<double, 6, 1>& x) { return moved_circle(s, frame(s), x); });
    if (!found) {
        undetermined(who, points.size(), "a circle");
    }
    return associated(circle, points, [&](const Vector3d& p) {
        const Vector3d w = p - circle.centre;
        return std::hypot(across(w, circle.normal).norm() - circle.radius, w.dot(circle.normal));
    });
}

Associated<Sphere> associated_sphere(Points points, const std::string& who) {
    const Centred c(points);
    const Eigen::Vector4d start = kasa<3>(c.v);
    Sphere sphere{c.centroid + start.head<3>(), start[3]};
    if (points.size() < 4 || !start.allFinite() || !settle<4>(sphere, points, c)) {
        undetermined(who, points.size(), "a sphere");
    }
    return associated(sphere, points, [&](const Vector3d& p) { return signed_distance(sphere, p); });
}

Associated<Sphere> associated_sphere(Points points, double radius, const std::string& who) {
    const Centred c(points);
    const Eigen::Vector4d start = kasa<3>(c.v);
    if (points.size() < 3 || !start.allFinite()) {
        undetermined(who, points.size(), "the centre of a ball");
    }
    // The free centre lies on the way out from the points; the known radius says how far.
    const double out = start.head<3>().norm();
    const Vector3d direction = out > 0 ? Vector3d(start.head<3>() / out) : Vector3d::UnitZ();
    const double depth = out > 0 ? std::max(0.0, radius - (start[3] - out)) : 0;
    Sphere sphere{c.centroid + depth * direction, radius};
    const bool found = gauss_newton<1, 3>(
        sphere, points, c.length,
        [](const Sphere& s, const Vector3d& p) {
            const Vector3d w = p - s.centre;
            return Rows<1, 3>{Eigen::Matrix<double, 1, 1>(w.norm() - s.radius),
                              -w.transpose() / detail::nonzero(w.norm())};
        },
        [](const Sphere& s, const Vector3d& step) {
            return Sphere{s.centre + step, s.radius};
        });
    if (!found) {
        undetermined(who, points.size(), "the centre of a ball");
    }
    return associated(sphere, points, [&](const Vector3d& p) { return signed_distance(sphere, p); });
}

Associated<Cylinder> associated_cylinder(Points points, const Vector3d& axis, const std::string& who) {
    const Centred c(points);
    const SurfaceFrame start = detail::frame_along(axis.normalized(), c.centroid, c.length);
    const Vector3d flat = flat_circle(c, start.e0, start.e1);
    Cylinder cylinder{c.centroid + flat[0] * start.e0 + flat[1] * start.e1, axis.normalized(), flat[2]};
    if (points.size() < 5 || !flat.allFinite() || !settle<5>(cylinder, points, c)) {
        undetermined(who, points.size(), "a cylinder");
    }
    cylinder.axis = with_sign(cylinder.axis);
    cylinder.point += cylinder.axis * cylinder.axis.dot(c.centroid - cylinder.point);
    return associated(cylinder, points, [&](const Vector3d& p) { return signed_distance(cylinder, p); });
}

}  // namespace seampath
