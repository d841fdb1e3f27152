#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <ostream>
#include <string_view>
#include <variant>
#include <vector>

#include "stages/nominal/nominal.hpp"

/// Saddles of the tests, and an independent solver for them.
namespace seampath {

/// Two pipes as the paper lays them.
inline SaddleCurve pipes(double R, double r, double angle_deg = 90, double offset_mm = 0) {
    SaddleDimensions dimensions;
    dimensions.header_radius_mm = R;
    dimensions.branch_radius_mm = r;
    dimensions.angle = angle_deg * std::numbers::pi / 180;
    dimensions.offset_mm = offset_mm;
    return saddle_of(dimensions);
}

/// How far the bisector of both walls leaves the plane through the branch's axis, rad.
inline double off_meridian(const SaddleCurve& curve) {
    double most = 0;
    for (int k = 0; k < 3600; ++k) {
        const SaddlePoint s = curve.at(2 * std::numbers::pi * k / 3600);
        const Eigen::Vector3d sideways = s.n1.cross(curve.branch().axis);
        most = std::max(most, std::asin(std::abs((s.n1 + s.n2).normalized().dot(sideways))));
    }
    return most;
}

struct NamedSaddle {
    std::string_view name;
    Cylinder branch;
    Eigen::Vector3d zero;
    Header header;
};
inline std::ostream& operator<<(std::ostream& out, const NamedSaddle& saddle) {
    return out << saddle.name;
}

inline std::vector<NamedSaddle> named_saddles() {
    using Eigen::Vector3d;
    const Vector3d up = Vector3d::UnitZ(), y = Vector3d::UnitY();
    const auto lean = [](double deg) {
        const double a = deg * std::numbers::pi / 180;
        return Vector3d(0, std::cos(a), std::sin(a));
    };
    const Eigen::Matrix3d turned = Eigen::AngleAxisd(0.4, Vector3d(1, 1, 0).normalized()).toRotationMatrix();
    const Cylinder header{{0, 0, 0}, y, 300};
    return {
        {"square", {{0, 0, 0}, up, 150}, y, Cylinder{{0, 0, 0}, y, 600}},
        {"leaning_and_offset", {{80, 0, 0}, lean(60), 100}, y, Cylinder{{0, 0, 0}, y, 200}},
        {"steep", {{0, 0, 0}, lean(45), 270}, y, header},
        {"nearly_tangent", {{195, 0, 0}, up, 100}, y, header},
        {"nearly_equal", {{0, 0, 0}, up, 149.9}, y, Cylinder{{0, 0, 0}, y, 150}},
        {"skew", {{40, 10, 0}, {0.3, 0.5, 0.8124038404635961}, 60}, Vector3d::UnitX(), header},
        {"plate", {{5, 7, 0}, lean(50), 40}, y, Plane{{1, 2, 3}, up}},
        {"sphere", {{120, 30, 0}, up, 50}, y, Sphere{{0, 0, 0}, 250}},
        {"cone_across", {{20, 300, 0}, up, 50}, y, Cone{{0, 0, 0}, y, 0.35}},
        {"cone_along", {{0, 0, 0}, up, 30}, y, Cone{{10, 0, 200}, -up, 0.5}},
        {"head", {{150, 60, 0}, {0.2, 0, 0.9797958971132712}, 45}, y, Ellipsoid{{5, 0, 0}, turned, {400, 400, 200}}},
    };
}

inline Cylinder moved(const Cylinder& s, const Eigen::Isometry3d& m) {
    return {m * s.point, m.linear() * s.axis, s.radius};
}
inline Header moved(const Header& header, const Eigen::Isometry3d& m) {
    struct Mover {
        const Eigen::Isometry3d& m;
        Header operator()(const Plane& s) const { return Plane{m * s.point, m.linear() * s.normal}; }
        Header operator()(const Cylinder& s) const { return moved(s, m); }
        Header operator()(const Cone& s) const { return Cone{m * s.apex, m.linear() * s.axis, s.half_angle}; }
        Header operator()(const Sphere& s) const { return Sphere{m * s.centre, s.radius}; }
        Header operator()(const Ellipsoid& s) const {
            return Ellipsoid{m * s.centre, m.linear() * s.axes, s.semi_axes};
        }
    };
    return std::visit(Mover{m}, header);
}

/// Finds the seam by walking each generator line from the outside inwards to the first change of sign of the header's
/// equation, and bisecting it.
class SaddleOracle {
public:
    using Vector = Eigen::Matrix<long double, 3, 1>;

    SaddleOracle(const Cylinder& branch, const Eigen::Vector3d& zero, const Header& header)
        : point_(branch.point.cast<long double>()),
          a_(branch.axis.cast<long double>().normalized()),
          r_(static_cast<long double>(branch.radius)),
          header_(header) {
        e1_ = (zero.cast<long double>() - zero.cast<long double>().dot(a_) * a_).normalized();
        e2_ = e1_.cross(a_);
    }

    struct Place {
        Eigen::Vector3d p, tangent;
        double curvature;
    };
    Place at(double theta) const {
        const long double h = 1e-4L, t = static_cast<long double>(theta);
        long double u = outermost(t);
        std::array<Vector, 5> p;
        for (int k = 0; k < 5; ++k) {
            p[static_cast<std::size_t>(k)] = on_seam(t + (k - 2) * h, u);
        }
        // Central differences of fourth order.
        const Vector d1 = (p[0] - 8 * p[1] + 8 * p[3] - p[4]) / (12 * h);
        const Vector d2 = (-p[0] + 16 * p[1] - 30 * p[2] + 16 * p[3] - p[4]) / (12 * h * h);
        const long double curvature = d1.cross(d2).norm() / std::pow(d1.norm(), 3.0L);
        return {p[2].cast<double>(), d1.normalized().cast<double>(), static_cast<double>(curvature)};
    }

    /// Of inscribed polygons, extrapolated twice (Richardson: the error is a series in 1/n^2).
    double length() const {
        const long double L1 = polygon(1500), L2 = polygon(3000), L3 = polygon(6000);
        const long double M1 = (4 * L2 - L1) / 3, M2 = (4 * L3 - L2) / 3;
        return static_cast<double>((16 * M2 - M1) / 15);
    }

    /// Zero on the surface, below it inside.
    template <class P>
    static auto gap(const Plane& s, const P& p) {
        return s.normal.template cast<typename P::Scalar>().dot(p - s.point.template cast<typename P::Scalar>());
    }
    template <class P>
    static auto gap(const Cylinder& s, const P& p) {
        using T = typename P::Scalar;
        return (p - s.point.template cast<T>()).cross(s.axis.template cast<T>().normalized()).norm() - T(s.radius);
    }
    template <class P>
    static auto gap(const Sphere& s, const P& p) {
        return (p - s.centre.template cast<typename P::Scalar>()).norm() - typename P::Scalar(s.radius);
    }
    template <class P>
    static auto gap(const Cone& s, const P& p) {
        using T = typename P::Scalar;
        const P w = p - s.apex.template cast<T>();
        const P axis = s.axis.template cast<T>().normalized();
        return w.cross(axis).norm() - w.dot(axis) * std::tan(T(s.half_angle));
    }
    template <class P>
    static auto gap(const Ellipsoid& s, const P& p) {
        using T = typename P::Scalar;
        const P w = s.axes.transpose().template cast<T>() * (p - s.centre.template cast<T>());
        const P scaled = w.cwiseQuotient(s.semi_axes.template cast<T>());
        return T((scaled.norm() - 1) * T(s.semi_axes.minCoeff()));
    }

private:
    Vector on_line(long double theta, long double u) const {
        return point_ + r_ * (std::cos(theta) * e1_ + std::sin(theta) * e2_) + u * a_;
    }
    long double gap_at(long double theta, long double u) const {
        const Vector p = on_line(theta, u);
        return std::visit([&p](const auto& s) { return static_cast<long double>(gap(s, p)); }, header_);
    }
    long double outermost(long double theta) const {
        for (long double u = 3000; u > -3000; u -= 0.5L) {
            if (gap_at(theta, u) < 0) {
                return u + 0.25L;
            }
        }
        return 0;
    }
    /// `u` is within some millimetres of the root, and becomes it.
    Vector on_seam(long double theta, long double& u) const {
        long double reach = 0.5L;
        while (gap_at(theta, u - reach) >= 0 || gap_at(theta, u + reach) <= 0) {
            reach *= 1.5L;
        }
        long double low = u - reach, high = u + reach;
        for (int i = 0; i < 66; ++i) {
            u = 0.5L * (low + high);
            (gap_at(theta, u) < 0 ? low : high) = u;
        }
        return on_line(theta, u);
    }
    long double polygon(int n) const {
        const long double turn = 2 * std::numbers::pi_v<long double>;
        long double u = outermost(0), length = 0;
        Vector before = on_seam(0, u);
        for (int i = 1; i <= n; ++i) {
            const Vector p = on_seam(turn * i / n, u);
            length += (p - before).norm();
            before = p;
        }
        return length;
    }

    Vector point_, a_, e1_, e2_;
    long double r_;
    Header header_;
};

}  // namespace seampath
