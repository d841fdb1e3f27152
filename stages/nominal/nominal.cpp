#include "stages/nominal/nominal.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/SparseLU>

#include "stages/error.hpp"
#include "stages/geometry/bspline.hpp"

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

// Flank samples a span; they are interpolated linearly in between.
constexpr int kFlanksPerSpan = 8;

Vector3d exact(const SaddleCurve& curve, double station) {
    return curve.at(curve.theta(station)).p;
}

/// The periodic cubic spline through these points at its knots; knots.back() is one period after the first.
CubicBSpline interpolate(std::vector<double> knots, const std::vector<Vector3d>& points) {
    const std::size_t n = points.size();
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::MatrixXd right(n, 3);
    for (std::size_t i = 0; i < n; ++i) {
        const CubicBasis basis = cubic_basis(knots, n, true, knots[i]);
        for (int k = 0; k < 4; ++k) {
            entries.emplace_back(static_cast<int>(i), static_cast<int>(basis.control[k]), basis.value[k]);
        }
        right.row(static_cast<Eigen::Index>(i)) = points[i].transpose();
    }
    Eigen::SparseMatrix<double> matrix(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
    matrix.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SparseLU<Eigen::SparseMatrix<double>> solver(matrix);
    ensure(solver.info() == Eigen::Success, "cubic spline interpolation at the knots has one solution");
    const Eigen::MatrixXd control = solver.solve(right);
    CubicBSpline curve;
    curve.periodic = true;
    curve.knots = std::move(knots);
    for (Eigen::Index i = 0; i < control.rows(); ++i) {
        curve.control.push_back(control.row(i).transpose());
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
        if (worst > kModelTolerance_mm) {
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
