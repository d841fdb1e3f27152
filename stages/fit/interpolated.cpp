#include "stages/fit/interpolated.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "stages/error.hpp"
#include "stages/fit/node_table.hpp"
#include "stages/geometry/pieces.hpp"
#include "stages/geometry/polynomial.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;
using Values = std::vector<double>;

std::string quoted(FitModel model) {
    return "\"" + std::string(name(model)) + "\"";
}

/// What the interpolation of the nodes knows of the method.
struct Traits {
    Method method;
    Joint joint;       ///< between two nodes' pieces
    bool has_ends;     ///< can't go round
    bool equal_steps;  ///< needs them
};

Traits traits(FitModel model) {
    switch (model) {
        case FitModel::natural:
            return {Method::natural, kTwoDerivatives, true, false};
        case FitModel::clamped:
            return {Method::clamped, kTwoDerivatives, true, false};
        case FitModel::not_a_knot:
            return {Method::not_a_knot, kTwoDerivatives, true, false};
        case FitModel::periodic:
            return {Method::periodic, kTwoDerivatives, false, false};
        case FitModel::akima:
            return {Method::akima, kOneDerivative, false, false};
        case FitModel::pchip:
            return {Method::pchip, kOneDerivative, false, false};
        case FitModel::linear:
            return {Method::linear, kPositionOnly, false, false};
        case FitModel::parametric:
            return {Method::natural, kTwoDerivatives, false, false};
        case FitModel::newton_forward:
            return {Method::newton_forward, kPositionOnly, false, true};
        case FitModel::newton_backward:
            return {Method::newton_backward, kPositionOnly, false, true};
        case FitModel::stirling:
            return {Method::stirling, kPositionOnly, false, true};
        case FitModel::bessel:
            return {Method::bessel, kPositionOnly, false, true};
        case FitModel::lagrange:
            return {Method::lagrange, kPositionOnly, false, false};
        case FitModel::newton_divided:
            return {Method::newton_divided, kPositionOnly, false, false};
        case FitModel::automatic:
        case FitModel::saddle:
        case FitModel::spline:
            break;
    }
    ensure(false, "neither saddle nor smoothing spline interpolates anything");
    return {};
}

void check_model(const FitOptions& o, bool closed, std::size_t nodes) {
    const Traits t = traits(o.model);
    const std::string model = "fit: fit.model " + quoted(o.model);
    if (closed && t.has_ends) {
        throw InputError(model +
                         " is for a line with two ends, and the seam is closed; set fit.model to parametric, "
                         "periodic, akima, pchip, linear or spline");
    }
    if (!closed && o.model == FitModel::periodic) {
        throw InputError(model +
                         " is for closed seams, and this one has two ends; set fit.model to parametric, "
                         "natural, not-a-knot, akima, pchip, linear or spline");
    }
    if (o.axis != FitAxis::length && (closed || o.model == FitModel::parametric)) {
        throw InputError("fit: fit.axis " + std::string(kFitAxisNames[static_cast<std::size_t>(o.axis)]) +
                         (closed ? ": a closed seam turns back along every axis"
                                 : ": the parametric model follows the seam's length") +
                         "; set fit.axis to length");
    }
    const std::size_t least = closed ? 3 : 2;
    if (nodes < least) {
        throw InputError("fit: the seam has " + std::to_string(nodes) + " nodes; at least " + std::to_string(least) +
                         " were needed; lower place.chord_tolerance_mm or place.max_spacing_mm");
    }
}

/// The splines' own pieces, from interval `first` on.
CubicPieces cubic_pieces(const Lines& lines, std::size_t first, std::size_t count, Joint joint) {
    CubicPieces pieces;
    for (std::size_t i = first; i < first + count; ++i) {
        const auto of = [&](Values PiecewiseCubic::*member) {
            return Vector3d(((*lines[0].cubic).*member)[i], ((*lines[1].cubic).*member)[i],
                            ((*lines[2].cubic).*member)[i]);
        };
        pieces.breaks.push_back(lines[0].t[i]);
        pieces.coefficients.push_back(
            {of(&PiecewiseCubic::a), of(&PiecewiseCubic::b), of(&PiecewiseCubic::c), of(&PiecewiseCubic::d)});
        pieces.joints.push_back(joint);
    }
    pieces.breaks.push_back(lines[0].t[first + count]);
    return pieces;
}

/// Stirling's formulas about the nodes on both sides of x, each with the weight 1 - |U|. Both pass both nodes, so the
/// line has the value and slope of a node's own formula there.
double stirling_value(const DifferenceTable& table, std::size_t degree, double x) {
    const std::size_t i = table.interval(x);
    const auto about = [&](std::size_t node) {
        Placement at = place(table, Formula::stirling, table.x(node), degree);
        at.u = (x - table.x(at.origin)) / table.step();
        return value(table, at);
    };
    const double share = (x - table.x(i)) / table.step();
    return (1 - share) * about(i) + share * about(i + 1);
}

Lines stirling_lines(const NodeTable& nodes, std::size_t degree) {
    Lines lines;
    for (Eigen::Index c = 0; c < 3; ++c) {
        Values y;
        for (const Vector3d& p : nodes.p) {
            y.push_back(p[c]);
        }
        Interpolant& line = lines[static_cast<std::size_t>(c)];
        line.method = Method::stirling;
        line.t = nodes.t;
        line.at = [table = DifferenceTable(nodes.t, y, degree), degree](double t) {
            return Eigen::Vector2d(t, stirling_value(table, degree, t));
        };
    }
    return lines;
}

/// A polynomial of degree 5 at most, in the powers of its place in the interval, 0 to 1.
using Quintic = std::array<Vector3d, 6>;

Quintic quintic(const Lines& lines, double from, double to) {
    constexpr std::array<double, 6> kPlaces{0, 0.2, 0.4, 0.6, 0.8, 1};
    Quintic result;
    for (std::size_t c = 0; c < 3; ++c) {
        Values y;
        for (const double place : kPlaces) {
            y.push_back(lines[c].at(place < 1 ? from + place * (to - from) : to).y());
        }
        const Values a = power_coefficients(kPlaces, divided_differences(kPlaces, y));
        for (std::size_t k = 0; k < a.size(); ++k) {
            result[k][static_cast<Eigen::Index>(c)] = a[k];
        }
    }
    return result;
}

Vector3d value(const Quintic& a, double x) {
    return a[0] + x * (a[1] + x * (a[2] + x * (a[3] + x * (a[4] + x * a[5]))));
}
Vector3d slope(const Quintic& a, double x) {
    return a[1] + x * (2 * a[2] + x * (3 * a[3] + x * (4 * a[4] + 5 * x * a[5])));
}

/// Hermite's cubics over the polynomial between every two nodes: off by no more than |f''''| h^4 / 384, where f'''' is
/// linear.
CubicPieces hermite_pieces(const Lines& lines, std::size_t first, std::size_t count, Joint joint) {
    CubicPieces pieces;
    for (std::size_t i = first; i < first + count; ++i) {
        const double from = lines[0].t[i], h = lines[0].t[i + 1] - from;
        const Quintic f = quintic(lines, from, from + h);
        const double fourth = std::max((24 * f[4]).norm(), (24 * f[4] + 120 * f[5]).norm());
        const int n = std::max(1, static_cast<int>(std::ceil(std::pow(fourth / 384 / kPolynomialTolerance_mm, 0.25))));
        for (int k = 0; k < n; ++k) {
            const double x0 = static_cast<double>(k) / n, x1 = (k + 1.0) / n, w = h / n;
            const Vector3d b = slope(f, x0) / h, end = slope(f, x1) / h, chord = (value(f, x1) - value(f, x0)) / w;
            pieces.breaks.push_back(from + x0 * h);
            pieces.coefficients.push_back(
                {value(f, x0), b, (3 * chord - 2 * b - end) / w, (b + end - 2 * chord) / (w * w)});
            pieces.joints.push_back(k == 0 ? joint : kOneDerivative);
        }
    }
    pieces.breaks.push_back(lines[0].t[first + count]);
    return pieces;
}

CubicPieces pieces_of(const NodeTable& table, bool closed, const FitOptions& o) {
    Traits use = traits(o.model);
    InterpolateOptions options;
    options.degree = static_cast<std::size_t>(o.degree);
    const bool by_nodes = o.model == FitModel::lagrange || o.model == FitModel::newton_divided;
    if (by_nodes && o.degree % 2 == 0) {
        --options.degree;
    }
    if (closed && o.model == FitModel::parametric) {
        use.method = Method::periodic;
    }
    const bool whole = use.method == Method::periodic;  // sees all of the ring; the others see a few nodes
    const std::ptrdiff_t before = closed && !whole ? kBeyond : 0;
    const NodeTable seen = closed ? carried_on(table, before, before + 1) : table;
    const bool blends = o.model == FitModel::stirling && o.degree >= 2 && seen.t.size() >= 3;
    if (blends) {
        use.joint = kOneDerivative;
    }
    const Lines lines = blends ? stirling_lines(seen, options.degree) : interpolated(seen, use.method, options);
    const auto first = static_cast<std::size_t>(before);
    const std::size_t count = table.t.size() - (closed ? 0 : 1);
    return lines[0].cubic ? cubic_pieces(lines, first, count, use.joint)
                          : hermite_pieces(lines, first, count, use.joint);
}

/// Parameters of the points nearest to the points, found from where they lie between the nodes. The ends of an open
/// curve are the seam's.
void project(CurvePoints& points, const Values& s, NodeTable table, const CubicBSpline& curve) {
    if (curve.periodic) {
        table.s.push_back(s.back() + table.s.front());
        table.t.push_back(table.t.front() + table.period);
    }
    for (std::size_t i = 0; i < points.p.size(); ++i) {
        const double at = s[i] < table.s.front() ? s[i] + s.back() : s[i];
        const auto above = std::upper_bound(table.s.begin() + 1, table.s.end() - 1, at);
        const auto k = static_cast<std::size_t>(above - table.s.begin());
        const double share = std::clamp((at - table.s[k - 1]) / (table.s[k] - table.s[k - 1]), 0.0, 1.0);
        const double start = table.t[k - 1] + share * (table.t[k] - table.t[k - 1]);
        const bool end = !curve.periodic && (i == 0 || i + 1 == points.p.size());
        points.u[i] = end ? start : nearest_parameter(curve, points.p[i], start);
    }
}

}  // namespace

bool interpolates(FitModel model) {
    return model != FitModel::automatic && model != FitModel::saddle && model != FitModel::spline;
}

bool sets_nodes(FitModel model) {
    return interpolates(model) && traits(model).equal_steps;
}

FittedCurve interpolate_nodes(CurvePoints& points, const Nodes& nodes, bool closed, const FitOptions& options) {
    check_model(options, closed, nodes.index.size());
    const Values s = lengths(points.p, closed);
    NodeTable table = placed_nodes(points, s, nodes, closed, options);
    if (sets_nodes(options.model)) {
        table = equal_nodes(points, s, table, closed, options);
    }
    FittedCurve fitted{as_bspline(pieces_of(table, closed, options), closed), static_cast<double>(table.t.size()), {}};
    project(points, s, table, fitted.curve);
    return fitted;
}

}  // namespace seampath
