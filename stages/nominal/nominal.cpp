#include "stages/nominal/nominal.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "stages/error.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/geometry/tridiagonal.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;

constexpr double kTurn = 2 * std::numbers::pi;

// A last step shorter than this share of the others is rounding and goes to the one before.
constexpr double kLastStep = 1e-9;

// The model's spline: knots to begin with, places in each span at which it is compared with the exact curve, and what
// may be between them. 1e-7 mm is a thousandth of what any program file resolves.
constexpr std::size_t kFirstKnots = 64, kMostKnots = 200000;
constexpr int kChecks = 4;
constexpr double kModelTolerance_mm = 1e-7;

// What coordinates lose to rounding, as a share of the largest: it counts on headers of 10 km and more.
constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();

// Flank samples a span; they are interpolated linearly in between.
constexpr int kFlanksPerSpan = 8;

Vector3d exact(const SaddleCurve& curve, double station) {
    return curve.at(curve.theta(station)).p;
}

/// The periodic cubic spline through these points at its knots; knots.back() is one period after the first.
CubicBSpline interpolate(std::vector<double> knots, const std::vector<Vector3d>& points) {
    const std::size_t n = points.size();
    // At knot i the control points i, i + 1 and i + 2 count: the middle one is the unknown of row i.
    std::vector<double> lower(n), diagonal(n), upper(n), right(n);
    for (std::size_t i = 0; i < n; ++i) {
        const CubicBasis basis = cubic_basis(knots, n, true, knots[i]);
        lower[i] = basis.value[0];
        diagonal[i] = basis.value[1];
        upper[i] = basis.value[2];
    }
    CubicBSpline curve;
    curve.periodic = true;
    curve.knots = std::move(knots);
    curve.control.resize(n);
    for (int axis = 0; axis < 3; ++axis) {
        std::transform(points.begin(), points.end(), right.begin(), [axis](const Vector3d& p) { return p[axis]; });
        const std::vector<double> control = solve_cyclic(lower, diagonal, upper, right);
        for (std::size_t i = 0; i < n; ++i) {
            curve.control[(i + 1) % n][axis] = control[i];
        }
    }
    return curve;
}

struct Fitted {
    CubicBSpline curve;
    double rms_mm = 0, max_mm = 0;
};

/// One round: the spline on these knots, and the middles of the spans in which it is off.
std::pair<Fitted, std::vector<double>> fit_once(const SaddleCurve& saddle, const std::vector<double>& knots) {
    std::vector<Vector3d> points;
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
        points.push_back(exact(saddle, knots[i]));
    }
    double extent = 0;
    for (const Vector3d& p : points) {
        extent = std::max(extent, p.cwiseAbs().maxCoeff());
    }
    const double tolerance = std::max(kModelTolerance_mm, kRounding * extent);
    Fitted fitted{interpolate(knots, points)};
    std::vector<double> more;
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
        double worst = 0;
        for (int k = 1; k < kChecks; ++k) {
            const double station = knots[i] + (knots[i + 1] - knots[i]) * k / kChecks;
            const double off = (position(fitted.curve, station) - exact(saddle, station)).norm();
            worst = std::max(worst, off);
            fitted.rms_mm += off * off;
        }
        fitted.max_mm = std::max(fitted.max_mm, worst);
        if (worst > tolerance) {
            more.push_back(0.5 * (knots[i] + knots[i + 1]));
        }
    }
    fitted.rms_mm = std::sqrt(fitted.rms_mm / static_cast<double>((knots.size() - 1) * (kChecks - 1)));
    return {std::move(fitted), std::move(more)};
}

Fitted fit_exactly(const SaddleCurve& saddle) {
    std::vector<double> knots;
    for (std::size_t i = 0; i <= kFirstKnots; ++i) {
        knots.push_back(saddle.length() * static_cast<double>(i) / kFirstKnots);
    }
    while (true) {
        auto [fitted, more] = fit_once(saddle, knots);
        if (more.empty()) {
            return std::move(fitted);
        }
        knots.insert(knots.end(), more.begin(), more.end());
        std::sort(knots.begin(), knots.end());
        ensure(knots.size() < kMostKnots, "a saddle without corners needs few knots");
    }
}

}  // namespace

SaddleCurve saddle_of(const SaddleDimensions& d) {
    if (!(d.angle > 0 && d.angle < std::numbers::pi)) {
        throw InputError("saddle: the angle between the branch and the header is " +
                         shortest(d.angle * 180 / std::numbers::pi) +
                         " deg; an angle between 0 and 180 deg is needed; 90 is a branch that stands upright");
    }
    const Vector3d origin = Vector3d::Zero(), y = Vector3d::UnitY();
    const Vector3d axis(0, std::cos(d.angle), std::sin(d.angle)), zero(0, std::sin(d.angle), -std::cos(d.angle));
    const Cylinder branch{{d.offset_mm, 0, 0}, axis, d.branch_radius_mm};
    const double R = d.header_radius_mm;
    switch (d.header) {
        case HeaderKind::plane:
            return {branch, zero, Plane{origin, Vector3d::UnitZ()}};
        case HeaderKind::cone:
            return {branch, zero, Cone{-R / std::tan(d.cone_half_angle) * y, y, d.cone_half_angle}};
        case HeaderKind::sphere:
            return {branch, zero, Sphere{origin, R}};
        case HeaderKind::ellipsoid:
            return {branch, zero, Ellipsoid{origin, Eigen::Matrix3d::Identity(), {R, R, d.head_depth_mm}}};
        case HeaderKind::cylinder:
            break;
    }
    return {branch, zero, Cylinder{origin, y, R}};
}

std::vector<double> step_angles(const SaddleCurve& curve, StepLaw law, double step_mm) {
    ensure(step_mm > 0, "a step has a length");
    const double steps = std::max(1.0, std::ceil(curve.length() / step_mm - kLastStep));
    std::vector<double> angles{0};
    const auto add = [&angles](double theta) { angles.push_back(theta); };
    if (law == StepLaw::equal_angle) {
        for (double k = 1; k < steps; ++k) {
            add(kTurn * k / steps);
        }
    } else if (law == StepLaw::arc_length) {
        for (double k = 1; k < steps; ++k) {
            add(curve.theta(k * step_mm));
        }
    } else {
        const auto next = [&] { return angles.back() + step_mm / curve.at(angles.back()).speed_mm_rad; };
        for (double theta = next(); theta < kTurn * (1 - kLastStep / steps); theta = next()) {
            add(theta);
        }
    }
    add(kTurn);
    return angles;
}

StepErrors step_errors(const SaddleCurve& curve, const std::vector<double>& angles, double step_mm) {
    StepErrors worst;
    for (std::size_t i = 1; i + 1 < angles.size(); ++i) {
        const double arc = curve.station(angles[i]) - curve.station(angles[i - 1]);
        const double chord = (curve.at(angles[i]).p - curve.at(angles[i - 1]).p).norm();
        worst.arc = std::max(worst.arc, std::abs(arc / step_mm - 1));
        worst.chord = std::max(worst.chord, std::abs(chord / step_mm - 1));
    }
    return worst;
}

double torch_angle(const SaddlePoint& point, PoseLaw law, double initial) {
    return law == PoseLaw::paper ? point.opening - std::numbers::pi / 2 + initial : point.opening / 2;
}

SeamModel nominal_model(const SaddleCurve& curve, PoseLaw law, double initial) {
    Fitted fitted = fit_exactly(curve);
    SeamModel model;
    model.kind = JointKind::saddle;
    model.closed = true;
    model.residual_rms_mm = fitted.rms_mm;
    model.residual_max_mm = fitted.max_mm;
    model.degrees_of_freedom = 3 * static_cast<double>(fitted.curve.control.size());
    const auto& knots = fitted.curve.knots;
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
        for (int k = 0; k < kFlanksPerSpan; ++k) {
            const double station = knots[i] + (knots[i + 1] - knots[i]) * k / kFlanksPerSpan;
            const SaddlePoint s = curve.at(curve.theta(station));
            // A turn about travel takes n1 towards the branch's wall, and the torch's angle from that wall down.
            const Eigen::AngleAxisd lean(s.opening / 2 - torch_angle(s, law, initial), s.tangent);
            model.flanks.push_back({station, lean * s.n1, lean * s.n2, 0, false});
        }
    }
    model.curve = std::move(fitted.curve);
    model.length_mm = ArcLength(model.curve).length();
    return model;
}

}  // namespace seampath
