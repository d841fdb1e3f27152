#include "stages/nominal/nominal.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/geometry/sampled_spline.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;

// A last step shorter than this share of the others is rounding and goes to the one before.
constexpr double kLastStep = 1e-9;

// What the model's spline may be off: a thousandth of what any program file resolves.
constexpr double kModelTolerance_mm = 1e-7;

// Flank samples a span; they are interpolated linearly in between.
constexpr int kFlanksPerSpan = 8;

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
    SampledSpline fitted = spline_through([&](double station) { return curve.at(curve.theta(station)).p; },
                                          curve.length(), true, kModelTolerance_mm);
    SeamModel model;
    model.kind = JointKind::saddle;
    model.closed = true;
    model.model = "saddle";
    model.reason = "computed from nominal dimensions";
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
