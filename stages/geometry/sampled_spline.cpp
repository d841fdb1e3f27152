#include "stages/geometry/sampled_spline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "stages/error.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/geometry/pieces.hpp"
#include "stages/geometry/piecewise_cubic.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;

// Knots to begin with, and places in each span at which the spline is compared with the curve.
constexpr std::size_t kFirstKnots = 64, kMostKnots = 200000;
constexpr int kChecks = 4;

// What coordinates lose to rounding, as a share of the largest: it counts on headers of 10 km and more.
constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();

/// The spline through these points at these knots; a closed one is back at its first point at the last knot.
CubicBSpline interpolate(const std::vector<double>& knots, const std::vector<Vector3d>& points, bool closed) {
    std::array<PiecewiseCubic, 3> line;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        std::vector<double> values;
        for (const Vector3d& p : points) {
            values.push_back(p[static_cast<Eigen::Index>(axis)]);
        }
        line[axis] = closed ? periodic_spline(knots, values) : not_a_knot_spline(knots, values);
    }
    CubicPieces pieces{knots, {}, std::vector<Joint>(knots.size() - 1, kTwoDerivatives)};
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
        const auto of = [&](std::vector<double> PiecewiseCubic::*member) {
            return Vector3d((line[0].*member)[i], (line[1].*member)[i], (line[2].*member)[i]);
        };
        pieces.coefficients.push_back(
            {of(&PiecewiseCubic::a), of(&PiecewiseCubic::b), of(&PiecewiseCubic::c), of(&PiecewiseCubic::d)});
    }
    return as_bspline(pieces, closed);
}

/// One round: the spline on these knots, and the middles of the spans in which it is off.
std::pair<SampledSpline, std::vector<double>> sample(const std::function<Vector3d(double)>& at,
                                                     const std::vector<double>& knots, bool closed, double tolerance) {
    std::vector<Vector3d> points;
    double extent = 0;
    for (std::size_t i = 0; i < knots.size(); ++i) {
        points.push_back(closed && i + 1 == knots.size() ? points.front() : at(knots[i]));
        extent = std::max(extent, points.back().cwiseAbs().maxCoeff());
    }
    const double allowed = std::max(tolerance, kRounding * extent);
    SampledSpline sampled{interpolate(knots, points, closed)};
    std::vector<double> more;
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
        double worst = 0;
        for (int k = 1; k < kChecks; ++k) {
            const double u = knots[i] + (knots[i + 1] - knots[i]) * k / kChecks;
            const double off = (position(sampled.curve, u) - at(u)).norm();
            worst = std::max(worst, off);
            sampled.rms_mm += off * off;
        }
        sampled.max_mm = std::max(sampled.max_mm, worst);
        if (worst > allowed) {
            more.push_back(0.5 * (knots[i] + knots[i + 1]));
        }
    }
    sampled.rms_mm = std::sqrt(sampled.rms_mm / static_cast<double>((knots.size() - 1) * (kChecks - 1)));
    return {std::move(sampled), std::move(more)};
}

}  // namespace

SampledSpline spline_through(const std::function<Vector3d(double)>& at, double length, bool closed, double tolerance) {
    std::vector<double> knots;
    for (std::size_t i = 0; i <= kFirstKnots; ++i) {
        knots.push_back(length * static_cast<double>(i) / kFirstKnots);
    }
    while (true) {
        auto [sampled, more] = sample(at, knots, closed, tolerance);
        if (more.empty()) {
            return std::move(sampled);
        }
        knots.insert(knots.end(), more.begin(), more.end());
        std::sort(knots.begin(), knots.end());
        ensure(knots.size() < kMostKnots, "a smooth curve needs few knots");
    }
}

}  // namespace seampath
