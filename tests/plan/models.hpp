#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "stages/geometry/bspline.hpp"
#include "stages/types.hpp"

/// Seam models of curves that are known in closed form.
namespace seampath::test {

/// A place of a seam with its flank normals, as a function of t in 0..1.
struct Place {
    Eigen::Vector3d p, n1, n2;
};
using Course = std::function<Place(double)>;

/// Least squares of 20 samples a control point, at parameters that are their polyline's length. Within 1e-6 mm of the
/// course for the courses below.
inline SeamModel model_of(const Course& course, bool closed, int controls) {
    const int samples = 20 * controls;
    std::vector<Place> places;
    std::vector<double> u{0};
    for (int j = 0; j <= samples; ++j) {
        places.push_back(course(static_cast<double>(j) / samples));
        if (j > 0) {
            u.push_back(u.back() + (places[j].p - places[j - 1].p).norm());
        }
    }
    SeamModel model;
    model.closed = closed;
    CubicBSpline& curve = model.curve;
    curve.periodic = closed;
    const int spans = closed ? controls : controls - 3;
    for (int k = closed ? 0 : -3; k <= spans + (closed ? 0 : 3); ++k) {
        curve.knots.push_back(u.back() * std::clamp(k, 0, spans) / spans);
    }
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(controls, controls);
    Eigen::MatrixXd B = Eigen::MatrixXd::Zero(controls, 3);
    for (int j = 0; j < samples + (closed ? 0 : 1); ++j) {
        const CubicBasis basis = cubic_basis(curve.knots, controls, closed, u[j]);
        for (int r = 0; r < 4; ++r) {
            B.row(basis.control[r]) += basis.value[r] * places[j].p.transpose();
            for (int c = 0; c < 4; ++c) {
                A(basis.control[r], basis.control[c]) += basis.value[r] * basis.value[c];
            }
        }
    }
    const Eigen::MatrixXd X = A.ldlt().solve(B);
    for (int i = 0; i < controls; ++i) {
        curve.control.push_back(X.row(i).transpose());
    }
    const ArcLength arc(curve);
    model.length_mm = arc.length();
    for (int j = 0; j < samples + (closed ? 0 : 1); j += 5) {
        model.flanks.push_back({arc.station(u[j]), places[j].n1, places[j].n2, 0.02, false});
    }
    return model;
}

inline constexpr double kPi = std::numbers::pi;

/// Pipe of that radius standing on the plate z = 0, seen from above: counter-clockwise. Flanks: pipe wall and plate.
inline Course circle(double radius) {
    return [=](double t) {
        const Eigen::Vector3d out(std::cos(2 * kPi * t), std::sin(2 * kPi * t), 0);
        return Place{radius * out, Eigen::Vector3d::UnitZ(), out};
    };
}

/// Along +X, web to the left of the plate: flanks +Y and +Z.
inline Course line(double length) {
    return [=](double t) { return Place{{length * t, 0, 0}, Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ()}; };
}

/// One and a half turns; flanks are the cylinder's outward normal and the normal of the helicoid, as of a screw's
/// flank.
inline Course helix(double radius, double pitch) {
    return [=](double t) {
        const double a = 3 * kPi * t, rise = pitch / (2 * kPi);
        const Eigen::Vector3d out(std::cos(a), std::sin(a), 0), round(-std::sin(a), std::cos(a), 0);
        const Eigen::Vector3d travel = (radius * round + rise * Eigen::Vector3d::UnitZ()).normalized();
        return Place{radius * out + rise * a * Eigen::Vector3d::UnitZ(), travel.cross(out), out};
    };
}

/// A web on the plate z = 0 bent as y = A sin(2 pi x / L): symmetric about its middle, where a test at mid-span is
/// blind.
inline Course s_curve(double length, double amplitude) {
    return [=](double t) {
        const double k = 2 * kPi / length, x = length * t;
        const Eigen::Vector3d side = Eigen::Vector3d(-amplitude * k * std::cos(k * x), 1, 0).normalized();
        return Place{{x, amplitude * std::sin(k * x), 0}, side, Eigen::Vector3d::UnitZ()};
    };
}

/// Box on the plate z = 0, counter-clockwise: straight sides, round corners; starts in the middle of a side.
inline Course rounded_box(double side, double radius) {
    return [=](double t) {
        const double straight = side - 2 * radius, corner = 0.5 * kPi * radius;
        double s = t * 4 * (straight + corner) + 0.5 * straight;
        const double quarter = std::min(4.0, std::floor(s / (straight + corner)));
        s -= quarter * (straight + corner);
        const double a = s < straight ? 0 : (s - straight) / radius;
        const Eigen::Vector3d out(std::sin(a), -std::cos(a), 0);
        const Eigen::Vector3d centre(std::min(s, straight) - 0.5 * straight, -0.5 * straight, 0);
        const Eigen::AngleAxisd turn(0.5 * kPi * quarter, Eigen::Vector3d::UnitZ());
        return Place{turn * (centre + radius * out), Eigen::Vector3d::UnitZ(), turn * out};
    };
}

/// The same seam from its other end.
inline Course reversed(const Course& course) {
    return [=](double t) {
        const Place place = course(1 - t);
        return Place{place.p, place.n2, place.n1};
    };
}

/// The seam moved with its part.
inline Course moved(const Course& course, const Eigen::Isometry3d& motion) {
    return [=](double t) {
        const Place place = course(t);
        return Place{motion * place.p, motion.linear() * place.n1, motion.linear() * place.n2};
    };
}

}  // namespace seampath::test
