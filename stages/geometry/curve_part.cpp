#include "stages/geometry/curve_part.hpp"

#include <algorithm>
#include <cmath>

#include "stages/error.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/geometry/pieces.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;

// Knots nearer to each other, or to an end, than this share of the part are the same.
constexpr double kSameKnot = 1e-9;

// Coefficients of 1, v, v^2, v^3 from `from` on. All is evaluated inside the span, where no knot can take it for
// another; c'' is linear in it.
std::array<Vector3d, 4> coefficients(const CubicBSpline& curve, double from, double to) {
    const double span = to - from, half = 0.5 * span;
    const Vector3d low = second_derivative(curve, from + 0.25 * span);
    const Vector3d high = second_derivative(curve, from + 0.75 * span);
    const Vector3d third = (high - low) / half, second = low - 0.25 * span * third;
    const Vector3d first = derivative(curve, from + half) - half * (second + 0.5 * half * third);
    const Vector3d start = position(curve, from + half) - half * (first + half * (0.5 * second + half / 6 * third));
    return {start, first, 0.5 * second, third / 6};
}

// Where the part begins and where its knots lie, with their joints.
CubicPieces empty_pieces(const CubicBSpline& curve, double from, double to) {
    CubicPieces pieces{{from}, {}, {kTwoDerivatives}};
    const double first = first_parameter(curve), period = last_parameter(curve) - first;
    const double same = kSameKnot * (to - from);
    const double rounds = curve.periodic ? std::ceil((to - first) / period) : 0;
    for (double round = curve.periodic ? std::floor((from - first) / period) : 0; round <= rounds; ++round) {
        for (std::size_t k = 0; k + (curve.periodic ? 1 : 0) < curve.knots.size(); ++k) {
            const double at = curve.knots[k] + round * period;
            if (at <= from + same || at >= to - same) {
                continue;
            }
            if (at > pieces.breaks.back() + same) {
                pieces.breaks.push_back(at);
                pieces.joints.push_back(kTwoDerivatives);
            } else {
                pieces.joints.back() = static_cast<Joint>(std::min<int>(pieces.joints.back() + 1, kPositionOnly));
            }
        }
    }
    pieces.breaks.push_back(to);
    return pieces;
}

CubicPieces pieces_between(const CubicBSpline& curve, double from, double to) {
    CubicPieces pieces = empty_pieces(curve, from, to);
    for (std::size_t k = 0; k + 1 < pieces.breaks.size(); ++k) {
        pieces.coefficients.push_back(coefficients(curve, pieces.breaks[k], pieces.breaks[k + 1]));
    }
    return pieces;
}

}  // namespace

CubicBSpline reversed(const CubicBSpline& curve) {
    CubicBSpline result = curve;
    const double sum = curve.knots.front() + curve.knots.back();
    std::transform(curve.knots.rbegin(), curve.knots.rend(), result.knots.begin(), [sum](double k) { return sum - k; });
    std::reverse(result.control.begin(), result.control.end());
    if (curve.periodic) {
        // cubic_basis() of the first span takes control points 0 to 3: the last three go to the front.
        std::rotate(result.control.begin(), result.control.end() - 3, result.control.end());
    }
    return result;
}

CubicBSpline part_of(const CubicBSpline& curve, double from, double to, double before, double behind) {
    ensure(to > from, "a part of a curve has a length");
    CubicPieces pieces = pieces_between(curve, from, to);
    if (before > 0) {
        const Vector3d start = pieces.coefficients.front()[0], along = pieces.coefficients.front()[1];
        const double span = before / along.norm();
        pieces.breaks.insert(pieces.breaks.begin(), from - span);
        pieces.coefficients.insert(pieces.coefficients.begin(),
                                   {start - span * along, along, Vector3d::Zero(), Vector3d::Zero()});
        pieces.joints.insert(pieces.joints.begin() + 1, kOneDerivative);
    }
    if (behind > 0) {
        const auto& [c0, c1, c2, c3] = pieces.coefficients.back();
        const double v = to - pieces.breaks[pieces.breaks.size() - 2];
        const Vector3d end = c0 + v * (c1 + v * (c2 + v * c3)), along = c1 + v * (2 * c2 + 3 * v * c3);
        pieces.breaks.push_back(to + behind / along.norm());
        pieces.coefficients.push_back({end, along, Vector3d::Zero(), Vector3d::Zero()});
        pieces.joints.push_back(kOneDerivative);
    }
    return as_bspline(pieces, false);
}

CubicBSpline joined(const std::vector<CubicBSpline>& parts, bool closed) {
    ensure(!parts.empty(), "parts of a curve to join");
    CubicPieces all;
    all.breaks.push_back(first_parameter(parts.front()));
    for (const CubicBSpline& part : parts) {
        CubicPieces pieces = pieces_between(part, first_parameter(part), last_parameter(part));
        pieces.joints.front() = kPositionOnly;
        const double shift = all.breaks.back() - pieces.breaks.front();
        for (std::size_t k = 0; k < pieces.coefficients.size(); ++k) {
            all.breaks.push_back(pieces.breaks[k + 1] + shift);
            all.coefficients.push_back(pieces.coefficients[k]);
            all.joints.push_back(pieces.joints[k]);
        }
    }
    return as_bspline(all, closed);
}

}  // namespace seampath
