#include "stages/place/smooth_line.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "stages/error.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/geometry/piecewise_cubic.hpp"
#include "stages/geometry/smoothed.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;

/// Places between the feet are so many that a line of few feet is looked at often enough, too.
constexpr std::size_t kFewestPlaces = 2000;

/// |c''''|^(1/4) of a smooth curve at its inner knots, from the jumps of the third derivative, which is constant
/// between two knots.
struct FourthRoot {
    std::vector<double> s, value;  ///< station and |c''''|^(1/4) there

    FourthRoot(const CubicBSpline& curve, const ArcLength& arc) {
        std::vector<double> knot;
        std::vector<Vector3d> third;
        for (std::size_t k = 0; k + 1 < curve.knots.size(); ++k) {
            const double a = curve.knots[k], h = curve.knots[k + 1] - a;
            if (h > 0) {
                third.emplace_back((second_derivative(curve, a + 0.75 * h) - second_derivative(curve, a + 0.25 * h)) /
                                   (0.5 * h));
                knot.push_back(a);
            }
        }
        knot.push_back(curve.knots.back());
        for (std::size_t k = 1; k < third.size(); ++k) {
            const double apart = 0.5 * (knot[k + 1] - knot[k - 1]);
            s.push_back(arc.station(knot[k]));
            value.push_back(std::pow((third[k] - third[k - 1]).norm() / apart, 0.25));
        }
    }

    double at(double station) const {
        const auto above = std::lower_bound(s.begin(), s.end(), station);
        if (above == s.begin() || above == s.end()) {
            return s.empty() ? 0 : above == s.end() ? value.back() : value.front();
        }
        const auto k = static_cast<std::size_t>(above - s.begin());
        const double share = (station - s[k - 1]) / (s[k] - s[k - 1]);
        return (1 - share) * value[k - 1] + share * value[k];
    }
};

/// Feet in the order of the line; of a closed one counted from the first.
void add_feet(SmoothLine& line, const CurvePoints& points, const ArcLength& arc, const Vector3d& middle) {
    const std::size_t n = points.p.size();
    const double from = arc.station(points.u.front());
    const auto add = [&](std::size_t i, double s) {
        line.index.push_back(i);
        line.s.push_back(s);
        line.p.emplace_back(middle + position(arc.curve(), points.u[i]));
    };
    add(0, 0);
    const double end = line.closed ? line.length : arc.station(points.u.back());
    const double apart = 1e-3 * line.length / static_cast<double>(n);
    for (std::size_t i = 1; i + (line.closed ? 0 : 1) < n; ++i) {
        double step = arc.station(points.u[i]) - from - line.s.back();
        step = line.closed ? std::remainder(step, line.length) : step;
        const double s = line.s.back() + step;
        if (points.weight[i] > 0 && step > apart && s < end - apart) {
            add(i, s);
        }
    }
    if (!line.closed) {
        add(n - 1, end);
    }
}

void add_places(SmoothLine& line, const ArcLength& arc, double from, const Vector3d& middle) {
    const std::size_t intervals = line.s.size() - (line.closed ? 0 : 1);
    const std::size_t each = std::max<std::size_t>(1, (kFewestPlaces + intervals - 1) / intervals);
    for (std::size_t k = 0; k < intervals; ++k) {
        const double a = line.s[k], b = station_of(line, k + 1);
        for (std::size_t i = 0; i < each; ++i) {
            const double s = a + (b - a) * static_cast<double>(i) / static_cast<double>(each);
            const double u = arc.parameter(from + s);
            line.places.push_back({s, middle + position(arc.curve(), u), tangent(arc.curve(), u), k});
        }
    }
}

}  // namespace

double station_of(const SmoothLine& line, std::size_t foot) {
    const std::size_t n = line.s.size();
    return line.s[foot % n] + (foot >= n ? line.length : 0);
}

SmoothLine smooth_line(const Seam& seam) {
    const Vector3d middle = middle_of(seam);
    CurvePoints points = points_about(seam, middle);
    const bool has_length =
        std::any_of(points.p.begin(), points.p.end(), [&](const Vector3d& p) { return p != points.p.front(); });
    if (!has_length) {
        throw InputError("place: the seam has no length; all its points coincide; check the scan");
    }
    const ArcLength arc(smooth_points(points, seam.closed).curve);
    SmoothLine line;
    line.closed = seam.closed;
    line.length = arc.length();
    add_feet(line, points, arc, middle);
    if (line.index.size() < 4) {
        throw InputError("place: only " + std::to_string(line.index.size()) + " of the seam's " +
                         std::to_string(points.p.size()) +
                         " points follow each other along it; at least 4 were needed; check the scan");
    }
    const double from = arc.station(points.u.front());
    const FourthRoot density(arc.curve(), arc);
    for (std::size_t k = 0; k + (line.closed ? 0 : 1) < line.s.size(); ++k) {
        const double a = line.s[k], b = station_of(line, k + 1), half = from + 0.5 * (a + b);
        line.weight.push_back((b - a) * density.at(half > arc.length() ? half - arc.length() : half));
    }
    add_places(line, arc, from, middle);
    return line;
}

Chosen held_against(const SmoothLine& line, std::vector<std::size_t> foot) {
    ensure(foot.size() >= (line.closed ? 4 : 2), "a spline has nodes");
    std::vector<double> t;
    for (const std::size_t f : foot) {
        t.push_back(line.s[f]);
    }
    if (line.closed) {
        t.push_back(t.front() + line.length);
    }
    std::array<PiecewiseCubic, 3> cubic;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        std::vector<double> y;
        for (std::size_t k = 0; k < t.size(); ++k) {
            y.push_back(line.p[foot[k % foot.size()]][static_cast<Eigen::Index>(axis)]);
        }
        cubic[axis] = line.closed ? periodic_spline(t, y) : not_a_knot_spline(t, y);
    }
    Chosen chosen{std::move(foot), std::vector<double>(t.size() - 1, 0), 0};
    std::size_t k = line.closed ? t.size() - 2 : 0;  // before the first node of a ring lies the last interval
    for (const SmoothLine::Place& place : line.places) {
        if (const auto next = std::lower_bound(chosen.foot.begin(), chosen.foot.end(), place.after);
            next != chosen.foot.end() && *next == place.after) {
            k = std::min(static_cast<std::size_t>(next - chosen.foot.begin()), t.size() - 2);
        }
        const double s = place.s < t[k] ? place.s + line.length - t[k] : place.s - t[k];
        Vector3d off;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const PiecewiseCubic& c = cubic[axis];
            off[static_cast<Eigen::Index>(axis)] = c.a[k] + s * (c.b[k] + s * (c.c[k] + s * c.d[k]));
        }
        off -= place.p;
        const double distance = (off - off.dot(place.t) * place.t).norm();
        chosen.error[k] = std::max(chosen.error[k], distance);
        chosen.worst = std::max(chosen.worst, distance);
    }
    return chosen;
}

}  // namespace seampath
