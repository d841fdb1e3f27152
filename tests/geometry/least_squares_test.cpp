#include "stages/geometry/least_squares.hpp"

#include <array>
#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "stages/error.hpp"

/// Least-squares features against reference solutions in extended precision (long double), which share nothing with
/// the code under test: other parameters (angles of the direction), derivatives by differences, plain Newton steps on
/// the normal equations from the truth. The limits are those of the software tests of ISO 10360-6 in their best class:
/// 0.1 um and 0.1 urad.
namespace seampath {
namespace least_squares_test {

using Eigen::Vector3d;
using Real = long double;
using Real3 = Eigen::Matrix<Real, 3, 1>;
using Reals = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

constexpr double kUm = 1e-4, kUrad = 1e-7;

struct Pose {
    Vector3d centre, direction;
};

Vector3d random_direction(std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    return Vector3d(normal(random), normal(random), normal(random)).normalized();
}

Real3 direction(Real theta, Real phi) {
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

/// Parameters that make the sum of squares of `residuals` least, by Gauss-Newton with differences.
Reals reference(Reals x, const std::vector<Vector3d>& points, const Vector3d& origin,
                const std::function<void(const Reals&, const Real3&, std::vector<Real>&)>& residuals) {
    const auto all = [&](const Reals& parameters) {
        std::vector<Real> r;
        for (const Vector3d& p : points) {
            residuals(parameters, p.cast<Real>() - origin.cast<Real>(), r);
        }
        return Reals(Eigen::Map<Reals>(r.data(), static_cast<Eigen::Index>(r.size())));
    };
    for (int round = 0; round < 60; ++round) {
        const Reals r = all(x);
        Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic> J(r.size(), x.size());
        for (Eigen::Index k = 0; k < x.size(); ++k) {
            const Real h = 1e-6L;
            Reals up = x, down = x;
            up[k] += h, down[k] -= h;
            J.col(k) = (all(up) - all(down)) / (2 * h);
        }
        const Reals step = J.householderQr().solve(-r);
        x += step;
        if (step.norm() < 1e-15L) {
            break;
        }
    }
    return x;
}

class LeastSquares : public testing::TestWithParam<int> {
protected:
    std::mt19937_64 random{static_cast<std::uint64_t>(GetParam())};
    std::normal_distribution<double> normal;
    // Parts lie up to metres off the origin; form errors of hundredths of a millimetre are what is fitted through.
    Vector3d origin = 3000 * random_direction(random);
    Vector3d axis = random_direction(random);
    Vector3d e0 = axis.unitOrthogonal(), e1 = axis.cross(e0);
    double theta = std::acos(axis.z()), phi = std::atan2(axis.y(), axis.x());

    Vector3d noise() { return 0.03 * Vector3d(normal(random), normal(random), normal(random)); }
    double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }
    /// Distance of a point from where the reference has it, across the reference's direction.
    static double apart(const Vector3d& a, const Vector3d& b) { return (a - b).norm(); }
    static double turned(const Vector3d& a, const Vector3d& b) { return a.cross(b).norm(); }
};

TEST_P(LeastSquares, Plane) {
    std::vector<Vector3d> points;
    for (int i = 0; i < 40; ++i) {
        points.push_back(origin + uniform(-90, 90) * e0 + uniform(-20, 20) * e1 + noise());
    }
    const auto fit = associated_plane(points, "plane");
    const Reals x = reference(
        (Reals(3) << theta, phi, 0).finished(), points, origin,
        [](const Reals& a, const Real3& p, std::vector<Real>& r) { r.push_back(direction(a[0], a[1]).dot(p) - a[2]); });
    const Real3 n = direction(x[0], x[1]);
    EXPECT_LT(turned(fit.shape.normal, n.cast<double>()), kUrad);
    EXPECT_LT(std::abs(static_cast<double>(n.dot((fit.shape.point - origin).cast<Real>()) - x[2])), kUm);
}

TEST_P(LeastSquares, Line) {
    std::vector<Vector3d> points;
    for (int i = 0; i < 30; ++i) {
        points.push_back(origin + uniform(-100, 100) * axis + noise());
    }
    const auto fit = associated_line(points, "line");
    const Real3 u = e0.cast<Real>(), v = e1.cast<Real>();
    const auto foot = [&](const Reals& a) { return Real3(a[2] * u + a[3] * v); };
    const Reals x = reference((Reals(4) << theta, phi, 0, 0).finished(), points, origin,
                              [&](const Reals& a, const Real3& p, std::vector<Real>& r) {
                                  const Real3 d = direction(a[0], a[1]), w = p - foot(a), off = w - w.dot(d) * d;
                                  r.insert(r.end(), {off[0], off[1], off[2]});
                              });
    const Real3 d = direction(x[0], x[1]), w = (fit.shape.point - origin).cast<Real>() - foot(x);
    EXPECT_LT(turned(fit.shape.direction, d.cast<double>()), kUrad);
    EXPECT_LT(static_cast<double>((w - w.dot(d) * d).norm()), kUm);
}

TEST_P(LeastSquares, Circle) {
    const double radius = uniform(5, 80), arc = uniform(1, 6.2);
    std::vector<Vector3d> points;
    for (int i = 0; i < 25; ++i) {
        const double a = uniform(0, arc);
        points.push_back(origin + radius * (std::cos(a) * e0 + std::sin(a) * e1) + noise());
    }
    const auto fit = associated_circle(points, "circle");
    const Reals x = reference((Reals(6) << theta, phi, 0, 0, 0, radius).finished(), points, origin,
                              [](const Reals& a, const Real3& p, std::vector<Real>& r) {
                                  const Real3 n = direction(a[0], a[1]), w = p - Real3(a[2], a[3], a[4]);
                                  r.insert(r.end(), {(w - w.dot(n) * n).norm() - a[5], w.dot(n)});
                              });
    EXPECT_LT(turned(fit.shape.normal, direction(x[0], x[1]).cast<double>()), kUrad);
    EXPECT_LT(static_cast<double>(((fit.shape.centre - origin).cast<Real>() - Real3(x.segment<3>(2))).norm()), kUm);
    EXPECT_LT(std::abs(static_cast<double>(fit.shape.radius - x[5])), kUm);
}

TEST_P(LeastSquares, Sphere) {
    const double radius = uniform(3, 40), cap = uniform(0.4, 3.1);
    std::vector<Vector3d> points;
    for (int i = 0; i < 60; ++i) {
        const double z = uniform(std::cos(cap), 1), a = uniform(0, 6.28), s = std::sqrt(1 - z * z);
        points.push_back(origin + radius * (s * std::cos(a) * e0 + s * std::sin(a) * e1 + z * axis) + noise());
    }
    const auto free = associated_sphere(points, "sphere");
    const Reals x = reference((Reals(4) << 0, 0, 0, radius).finished(), points, origin,
                              [](const Reals& a, const Real3& p, std::vector<Real>& r) {
                                  r.push_back((p - Real3(a.head<3>())).norm() - a[3]);
                              });
    EXPECT_LT(static_cast<double>(((free.shape.centre - origin).cast<Real>() - Real3(x.head<3>())).norm()), kUm);
    EXPECT_LT(std::abs(static_cast<double>(free.shape.radius - x[3])), kUm);
    const auto known = associated_sphere(points, radius, "ball");
    const Reals y =
        reference(Reals::Zero(3), points, origin, [&](const Reals& a, const Real3& p, std::vector<Real>& r) {
            r.push_back((p - Real3(a.head<3>())).norm() - static_cast<Real>(radius));
        });
    EXPECT_LT(static_cast<double>(((known.shape.centre - origin).cast<Real>() - Real3(y.head<3>())).norm()), kUm);
    EXPECT_EQ(known.shape.radius, radius);
}

TEST_P(LeastSquares, Cylinder) {
    const double radius = uniform(4, 60), arc = uniform(1.2, 6.2);
    std::vector<Vector3d> points;
    for (int i = 0; i < 80; ++i) {
        const double a = uniform(0, arc);
        points.push_back(origin + radius * (std::cos(a) * e0 + std::sin(a) * e1) + uniform(-50, 50) * axis + noise());
    }
    const auto fit = associated_cylinder(points, (axis + 0.1 * e0).normalized(), "cylinder");
    const Real3 u = e0.cast<Real>(), v = e1.cast<Real>();
    const auto foot = [&](const Reals& a) { return Real3(a[2] * u + a[3] * v); };
    const Reals x = reference((Reals(5) << theta, phi, 0, 0, radius).finished(), points, origin,
                              [&](const Reals& a, const Real3& p, std::vector<Real>& r) {
                                  const Real3 d = direction(a[0], a[1]), w = p - foot(a);
                                  r.push_back((w - w.dot(d) * d).norm() - a[4]);
                              });
    const Real3 d = direction(x[0], x[1]), w = (fit.shape.point - origin).cast<Real>() - foot(x);
    EXPECT_LT(turned(fit.shape.axis, d.cast<double>()), kUrad);
    EXPECT_LT(static_cast<double>((w - w.dot(d) * d).norm()), kUm);
    EXPECT_LT(std::abs(static_cast<double>(fit.shape.radius - x[4])), kUm);
}

INSTANTIATE_TEST_SUITE_P(Seeds, LeastSquares, testing::Range(1, 21));

TEST(LeastSquaresInput, TooFewOrInLineIsRefused) {
    const std::vector<Vector3d> two{{0, 0, 0}, {1, 2, 3}}, line{{0, 0, 0}, {1, 2, 3}, {2, 4, 6}, {3, 6, 9}, {4, 8, 12}};
    EXPECT_THROW(associated_plane(two, "A"), InputError);
    EXPECT_THROW(associated_plane(line, "A"), InputError);
    EXPECT_THROW(associated_line({}, "A"), InputError);
    EXPECT_THROW(associated_circle(line, "A"), InputError);
    EXPECT_THROW(associated_sphere(line, "A"), InputError);
    EXPECT_THROW(associated_sphere(two, 5, "A"), InputError);
    EXPECT_THROW(associated_cylinder(line, {1, 0, 0}, "A"), InputError);
}

}  // namespace least_squares_test
}  // namespace seampath
