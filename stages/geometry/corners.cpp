#include "stages/geometry/corners.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include <Eigen/Cholesky>

#include "stages/geometry/arc.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/geometry/pieces.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/geometry/smoothed.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;

constexpr double kLeastTurn = 20 * std::numbers::pi / 180;
constexpr std::ptrdiff_t kFewestOfPiece = 6;

// What the points are like, apart from where they bend.
struct PointScatter {
    double noise = 0;    // mm, of a point in one direction across: what they state, or more when they show it
    double spacing = 0;  // mm
};

PointScatter scatter_of(const CurvePoints& points, bool closed) {
    const std::size_t n = points.p.size();
    std::vector<double> off, step, weight = points.weight;
    for (std::size_t i = 0; i + (closed ? 0 : 2) < n; ++i) {
        const Vector3d &a = points.p[i], &b = points.p[(i + 1) % n], &c = points.p[(i + 2) % n];
        off.push_back(nearest_on_segment(b, a, c).distance_mm);
        step.push_back((b - a).norm());
    }
    // The distance from the middle of two others has 3/2 of a point's variance in each direction, and half of what is
    // stated of a distance is of one.
    const double shown = quantile(off, 0.5) / std::sqrt(1.5 * 2 * std::numbers::ln2);
    return {std::max(shown, std::sqrt(0.5 / quantile(weight, 0.5))), quantile(step, 0.5)};
}

// The way along which points run up to a corner, as a parabola over the distance x from the one nearest to it, which
// counts against the corner: p + x d + x^2 c.
struct Approach {
    Vector3d p, d, c;
    double off = 0;             // mm, root mean square of the points in one direction
    double near = 0;            // mm, the largest distance of the three points nearest to the corner
    std::ptrdiff_t count = 0;   // of the points
    Eigen::Matrix3d cofactors;  // of the three coefficients

    Vector3d at(double x) const { return p + x * d + x * x * c; }
    Vector3d ahead(double x) const { return (d + 2 * x * c).normalized(); }
    double sigma(double x, double noise) const {
        const Vector3d row(1, x, x * x);
        return noise * std::sqrt(row.dot(cofactors * row));
    }
};

// From the points of these indices, the one nearest to the corner first; `degree` 1 or 2.
Approach approach(const std::vector<Vector3d>& points, const std::vector<std::size_t>& index, int degree) {
    Eigen::MatrixXd A(static_cast<Eigen::Index>(index.size()), degree + 1);
    Eigen::MatrixXd b(A.rows(), 3);
    double x = 0;
    for (Eigen::Index row = 0; row < A.rows(); ++row) {
        const Vector3d& p = points[index[static_cast<std::size_t>(row)]];
        x -= row > 0 ? (p - points[index[static_cast<std::size_t>(row) - 1]]).norm() : 0;
        for (int k = 0; k <= degree; ++k) {
            A(row, k) = std::pow(x, k);
        }
        b.row(row) = p.transpose();
    }
    const Eigen::MatrixXd normal = A.transpose() * A;
    const auto solver = normal.ldlt();
    const Eigen::MatrixXd coefficients = solver.solve(A.transpose() * b);
    const Eigen::MatrixXd inverse = solver.solve(Eigen::MatrixXd::Identity(degree + 1, degree + 1));
    Approach way{coefficients.row(0), coefficients.row(1), Vector3d::Zero(), 0, 0, A.rows(), Eigen::Matrix3d::Zero()};
    if (degree == 2) {
        way.c = coefficients.row(2);
    }
    way.cofactors.topLeftCorner(degree + 1, degree + 1) = inverse;
    double squares = 0;
    for (Eigen::Index row = 0; row < A.rows(); ++row) {
        // Steps along the way are no error of it.
        const Vector3d off = (b.row(row) - A.row(row) * coefficients).transpose(), t = way.ahead(A(row, 1));
        const double distance = (off - off.dot(t) * t).norm();
        squares += distance * distance;
        way.near = row < 3 ? std::max(way.near, distance) : way.near;
    }
    way.off = std::sqrt(squares / (2 * static_cast<double>(A.rows() - degree - 1)));
    return way;
}

// Whether the points of a way scatter about it no more than by chance.
bool explains(const Approach& way, int degree, double noise) {
    constexpr double kSurely = 3, kFarthest = 4.5;
    const double chance = 1 + kSurely / std::sqrt(4 * static_cast<double>(way.count - degree - 1));
    return way.off <= chance * noise && way.near <= kFarthest * noise;
}

// The approach that explains the most points up to `most`, doubled from the usual fewest; nothing when it explains not
// even those. A line where that is enough, a parabola where the points bend for sure.
std::optional<Approach> widest_approach(const std::vector<Vector3d>& p, std::ptrdiff_t from, std::ptrdiff_t by,
                                        std::ptrdiff_t most, double noise) {
    constexpr std::ptrdiff_t kFewest = 12, kMost = 96;  // fewer leave their direction in doubt, more help little
    constexpr double kSurelyBent = 4;
    const auto n = std::ssize(p);
    std::optional<Approach> widest;
    if (most < kFewestOfPiece) {
        return widest;
    }
    for (std::ptrdiff_t count = std::min(kFewest, most); count <= std::min(kMost, most); count *= 2) {
        std::vector<std::size_t> index;
        for (std::ptrdiff_t k = 0; k < count; ++k) {
            index.push_back(static_cast<std::size_t>(((from + k * by) % n + n) % n));
        }
        const Approach line = approach(p, index, 1), bent = approach(p, index, 2);
        const Vector3d across = bent.c - bent.c.dot(bent.d.normalized()) * bent.d.normalized();
        const bool bends = across.norm() > kSurelyBent * bent.off * std::sqrt(bent.cofactors(2, 2));
        if (!bends && explains(line, 1, noise)) {
            widest = line;
        } else if (explains(bent, 2, noise)) {
            widest = bent;
        } else {
            break;
        }
    }
    return widest;
}

// Where two ways meet, each so far beyond its last point.
struct Meeting {
    Vector3d p;
    double a = 0, b = 0, apart = 0;
};

Meeting meeting_of(const Approach& first, const Approach& second) {
    constexpr int kSteps = 8;
    Meeting m;
    for (int step = 0; step < kSteps; ++step) {
        const Vector3d r = second.at(m.b) - first.at(m.a), u = first.d + 2 * m.a * first.c,
                       v = second.d + 2 * m.b * second.c;
        const double uu = u.dot(u), vv = v.dot(v), uv = u.dot(v), det = uu * vv - uv * uv;
        m.a += (r.dot(u) * vv - r.dot(v) * uv) / det;
        m.b += (r.dot(u) * uv - r.dot(v) * uu) / det;
    }
    m.p = 0.5 * (first.at(m.a) + second.at(m.b));
    m.apart = (first.at(m.a) - second.at(m.b)).norm();
    return m;
}

// A corner, how many points its pieces explain and how well.
struct CornerFound {
    SeamCorner corner;
    std::ptrdiff_t explained = 0;
    double misfit = 0;

    bool better_than(const CornerFound& o) const {
        return std::tuple(-explained, misfit, corner.before) < std::tuple(-o.explained, o.misfit, o.corner.before);
    }
};

// Whether two ways turn by more than their bends, the noise and a smooth curve would.
bool turns_sharply(const Approach& before, const Approach& behind, const PointScatter& scatter, double noise) {
    constexpr double kSurely = 4;
    const double turn = std::acos(std::clamp(before.ahead(0).dot(-behind.ahead(0)), -1.0, 1.0));
    const double sigma = noise * std::sqrt(before.cofactors(1, 1) + behind.cofactors(1, 1));
    const double bend = 2 * std::max(before.c.norm(), behind.c.norm());
    return turn > kLeastTurn + kSurely * sigma + bend * static_cast<double>(kFewestOfPiece) * scatter.spacing;
}

// How much the way turns from as many points as a piece has at least before point i + 1 to as many from there on; 0
// where there are not so many.
double turn_over(const std::vector<Vector3d>& p, bool closed, std::ptrdiff_t i) {
    constexpr std::ptrdiff_t kHalf = kFewestOfPiece / 2;
    const auto n = std::ssize(p);
    if (!closed && (i + 1 < kFewestOfPiece || i + kFewestOfPiece >= n)) {
        return 0;
    }
    const auto middle = [&](std::ptrdiff_t first) {
        Vector3d sum = Vector3d::Zero();
        for (std::ptrdiff_t k = first; k < first + kHalf; ++k) {
            sum += p[static_cast<std::size_t>((k % n + n) % n)];
        }
        return sum;
    };
    const Vector3d in = middle(i - kHalf + 1) - middle(i - kFewestOfPiece + 1);
    const Vector3d out = middle(i + 1 + kHalf) - middle(i + 1);
    return std::atan2(in.cross(out).norm(), in.dot(out));
}

// A corner between a point and the next.
std::optional<CornerFound> corner_behind(const std::vector<Vector3d>& p, bool closed, std::ptrdiff_t i,
                                         const PointScatter& scatter) {
    constexpr double kReach = 5;  // point distances: measuring stops short of a corner
    constexpr double kTogether = 4;
    const auto n = std::ssize(p);
    const std::ptrdiff_t most = closed ? n / 2 : n;
    const auto before = widest_approach(p, i, -1, closed ? most : i + 1, scatter.noise);
    const auto behind = before ? widest_approach(p, i + 1, 1, closed ? most : n - 1 - i, scatter.noise) : std::nullopt;
    if (!behind) {
        return {};
    }
    const double noise = std::max({scatter.noise, before->off, behind->off});
    if (!turns_sharply(*before, *behind, scatter, noise)) {
        return {};
    }
    const Meeting m = meeting_of(*before, *behind);
    const double reach = kReach * scatter.spacing;
    const double sigma = std::hypot(before->sigma(m.a, noise), behind->sigma(m.b, noise));
    const double back = -kTogether * noise - 0.5 * scatter.spacing;  // a point in the corner may lie beyond it
    if (!(m.apart <= kTogether * sigma && m.a <= reach && m.b <= reach && m.a >= back && m.b >= back)) {
        return {};
    }
    return CornerFound{
        {static_cast<std::size_t>(i), m.p}, before->count + behind->count, before->off + behind->off + m.apart};
}

}  // namespace

std::vector<SeamCorner> corners_of(const CurvePoints& points, bool closed) {
    const auto n = std::ssize(points.p);
    if (n < 2 * kFewestOfPiece) {
        return {};
    }
    const PointScatter scatter = scatter_of(points, closed);
    std::vector<CornerFound> found;
    for (std::ptrdiff_t i = 0; i + (closed ? 0 : 1) < n; ++i) {
        if (turn_over(points.p, closed, i) < kLeastTurn) {
            continue;  // not worth looking closer
        }
        if (const auto corner = corner_behind(points.p, closed, i, scatter)) {
            found.push_back(*corner);
        }
    }
    // Of neighbouring places the one that fits best.
    std::vector<SeamCorner> corners;
    for (const CornerFound& one : found) {
        const bool best = std::none_of(found.begin(), found.end(), [&](const CornerFound& other) {
            const auto apart = std::abs(static_cast<std::ptrdiff_t>(other.corner.before) -
                                        static_cast<std::ptrdiff_t>(one.corner.before));
            return std::min(apart, closed ? n - apart : apart) < kFewestOfPiece && other.better_than(one);
        });
        if (best) {
            corners.push_back(one.corner);
        }
    }
    return corners;
}

namespace {

// The points between two corners, and the corners as points that hold the ends.
struct Stretch {
    CurvePoints points;
    std::vector<std::size_t> index;  // of the points without the corners
    bool begins_in_corner = false, ends_in_corner = false;
};

std::vector<Stretch> stretches_of(const CurvePoints& points, const std::vector<SeamCorner>& corners, bool closed) {
    constexpr double kHold = 1e4;  // of the usual weight
    std::vector<double> weights = points.weight;
    const double hold = kHold * quantile(weights, 0.5);
    const std::size_t n = points.p.size(), count = corners.size();
    std::vector<Stretch> stretches;
    for (std::size_t k = 0; k < count + (closed ? 0 : 1); ++k) {
        Stretch s;
        const SeamCorner* begin = closed ? &corners[k] : k > 0 ? &corners[k - 1] : nullptr;
        const SeamCorner* end = closed ? &corners[(k + 1) % count] : k < count ? &corners[k] : nullptr;
        const std::size_t first = begin ? begin->before + 1 : 0;
        std::size_t last = end ? end->before : n - 1;
        last += closed && last < first ? n : 0;
        const auto add = [&](const Vector3d& p, double weight) {
            s.points.p.push_back(p);
            s.points.weight.push_back(weight);
        };
        if (begin) {
            add(begin->p, hold);
        }
        for (std::size_t i = first; i <= last; ++i) {
            s.index.push_back(i % n);
            add(points.p[i % n], points.weight[i % n]);
        }
        if (end) {
            add(end->p, hold);
        }
        s.begins_in_corner = begin != nullptr;
        s.ends_in_corner = end != nullptr;
        s.points.u.assign(s.points.p.size(), 0);
        stretches.push_back(std::move(s));
    }
    return stretches;
}

// The spans of an open spline from `shift` on, with its ends in the corners.
void add_spans(CubicPieces& pieces, CubicBSpline curve, double shift, const Stretch& stretch) {
    if (stretch.begins_in_corner) {
        curve.control.front() = stretch.points.p.front();
    }
    if (stretch.ends_in_corner) {
        curve.control.back() = stretch.points.p.back();
    }
    for (std::size_t k = 3; k < curve.control.size(); ++k) {
        const double a = curve.knots[k], h = curve.knots[k + 1] - a;
        const Vector3d third =
            (second_derivative(curve, a + 0.75 * h) - second_derivative(curve, a + 0.25 * h)) / (0.5 * h);
        const Vector3d second = second_derivative(curve, a + 0.5 * h) - 0.5 * h * third;
        pieces.breaks.push_back(a + shift);
        pieces.coefficients.push_back({position(curve, a), derivative(curve, a), second / 2, third / 6});
        pieces.joints.push_back(k == 3 ? kPositionOnly : kTwoDerivatives);
    }
}

}  // namespace

FittedCurve smooth_pieces(CurvePoints& points, bool closed) {
    const std::vector<SeamCorner> corners = corners_of(points, closed);
    if (corners.empty()) {
        return smooth_points(points, closed);
    }
    FittedCurve fitted;
    CubicPieces pieces;
    double shift = 0;
    for (Stretch& stretch : stretches_of(points, corners, closed)) {
        const FittedCurve smooth = smooth_points(stretch.points, false);
        add_spans(pieces, smooth.curve, shift, stretch);
        const std::size_t skip = stretch.begins_in_corner ? 1 : 0;
        for (std::size_t k = 0; k < stretch.index.size(); ++k) {
            points.u[stretch.index[k]] = stretch.points.u[k + skip] + shift;
            points.weight[stretch.index[k]] = stretch.points.weight[k + skip];
        }
        for (const CurveSigma& sigma : smooth.sigma) {
            fitted.sigma.push_back({sigma.u + shift, sigma.sigma_mm});
        }
        if (stretch.ends_in_corner) {
            fitted.sigma.pop_back();  // the next piece says it
        }
        fitted.freedom += smooth.freedom;
        shift += last_parameter(smooth.curve);
    }
    pieces.breaks.push_back(shift);
    fitted.curve = as_bspline(pieces, closed);
    return fitted;
}

}  // namespace seampath
