#include "stages/geometry/smoothed.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "stages/error.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/geometry/curve_sigma.hpp"
#include "stages/geometry/outliers.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/geometry/smoothing.hpp"

namespace seampath {
namespace {

constexpr int kFootRounds = 4;  // a fifth moves the curve by less than a hundredth of its error

// Parameters by chord length. No chord counts for more than those that span it, so that a point off to a side makes no
// detour. Returns the parameter of the end: where a closed curve is back at its first point.
double set_parameters(CurvePoints& points, const std::vector<Eigen::Vector3d>& q, bool closed) {
    const auto n = static_cast<std::ptrdiff_t>(q.size());
    constexpr std::pair<int, int> kSpanning[] = {{-1, 0}, {-2, 0}, {-1, 1}, {-2, 1}, {-3, 1}, {-2, 2}};
    double u = 0;
    points.u.assign(q.size(), 0);
    for (std::ptrdiff_t i = 1; i < n + (closed ? 1 : 0); ++i) {
        double step = std::numeric_limits<double>::infinity();
        for (const auto& [before, behind] : kSpanning) {
            if (closed || (i + before >= 0 && i + behind < n)) {
                const auto at = [&](std::ptrdiff_t k) { return q[static_cast<std::size_t>((k + 3 * n) % n)]; };
                step = std::min(step, (at(i + behind) - at(i + before)).norm());
            }
        }
        u += step;
        if (i < n) {
            points.u[static_cast<std::size_t>(i)] = u;
        }
    }
    return u;
}

// Merges spans in which the curve is stiff, so that about so many are left for each coefficient it uses.
void thin(std::vector<double>& breaks, Smoothing& s, const PenalisedSpline& spline) {
    constexpr double kSpansPerFreedom = 3, kFewestSpans = 8;
    const double longest = (breaks.back() - breaks.front()) / kFewestSpans;
    std::vector<double> kept{breaks.front()}, lambda;
    double due = 0, log_lambda = 0;
    for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
        due += kSpansPerFreedom * spline.freedom(k, s.lambda[k]);
        log_lambda += (breaks[k + 1] - breaks[k]) * std::log(s.lambda[k]);
        if (due >= 1 || k + 2 == breaks.size() || breaks[k + 2] - kept.back() > longest) {
            lambda.push_back(std::exp(log_lambda / (breaks[k + 1] - kept.back())));
            kept.push_back(breaks[k + 1]);
            due = std::clamp(due - 1, 0.0, 1.0);
            log_lambda = 0;
        }
    }
    breaks = std::move(kept);
    s.lambda = std::move(lambda);
}

// Parameters of the points of the curve nearest to the points. The ends of an open curve stay where the seam's ends
// are. Returns how far the points are off the curve.
std::vector<Eigen::Vector3d> project(CurvePoints& points, const CubicBSpline& curve) {
    std::vector<Eigen::Vector3d> off;
    for (std::size_t i = 0; i < points.p.size(); ++i) {
        const bool end = !curve.periodic && (i == 0 || i + 1 == points.p.size());
        const FootPoint foot =
            end ? FootPoint{points.u[i], position(curve, points.u[i])} : foot_point(curve, points.p[i], points.u[i]);
        points.u[i] = foot.u;
        off.emplace_back(points.p[i] - foot.p);
    }
    return off;
}

// New parameters for points and breaks: length along the curve. Uneven speed would count as roughness.
void measure_along(CurvePoints& points, std::vector<double>& breaks, const CubicBSpline& curve) {
    constexpr int kPieces = 4;
    std::vector<double> u{breaks.front()}, length{0};
    Eigen::Vector3d last = position(curve, u[0]);
    for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
        for (int piece = 1; piece <= kPieces; ++piece) {
            u.push_back(breaks[k] + (breaks[k + 1] - breaks[k]) * piece / kPieces);
            const Eigen::Vector3d p = position(curve, piece < kPieces ? u.back() : std::nextafter(u.back(), 0.0));
            length.push_back(length.back() + (p - last).norm());
            last = p;
        }
    }
    const auto along = [&](double x) {
        const auto k =
            std::clamp<std::ptrdiff_t>(std::upper_bound(u.begin(), u.end(), x) - u.begin(), 1, std::ssize(u) - 1);
        const auto i = static_cast<std::size_t>(k);
        return length[i - 1] + (length[i] - length[i - 1]) * (x - u[i - 1]) / (u[i] - u[i - 1]);
    };
    for (double& x : points.u) {
        x = along(x);
    }
    for (double& x : breaks) {
        x = along(x);
    }
}

// The first round finds about how free the curve is, on knots at every point; the second whether that hangs on the
// place.
void choose_smoothing(PenalisedSpline& spline, const CurvePoints& points, Smoothing& s, int round, bool& uneven) {
    if (round == 0) {
        smooth_evenly(spline, points, s);
        return;
    }
    if (round == 1) {
        smooth_evenly(spline, points, s);
        Smoothing even = s;
        const double even_risk = set_level(spline, points, even);
        smooth_locally(spline, points, s);
        uneven = set_level(spline, points, s) < even_risk;
        s = uneven ? s : even;
    } else if (round == 2 && uneven) {
        smooth_evenly(spline, points, s);
        smooth_locally(spline, points, s);
    }
    set_level(spline, points, s);
}

}  // namespace

Eigen::Vector3d middle_of(const Seam& seam) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const SeamPoint& point : seam.points) {
        middle += point.p / static_cast<double>(seam.points.size());
    }
    return middle;
}

CurvePoints points_about(const Seam& seam, const Eigen::Vector3d& middle) {
    std::vector<double> sigma;
    for (const SeamPoint& point : seam.points) {
        sigma.push_back(point.sigma_mm);
    }
    const double least = std::max(1e-6, 0.1 * quantile(sigma, 0.5));  // one far below the usual would hold the curve
    CurvePoints points;
    for (const SeamPoint& point : seam.points) {
        points.p.emplace_back(point.p - middle);
        points.weight.push_back(std::pow(std::max(point.sigma_mm, least), -2));
    }
    points.u.assign(points.p.size(), 0);
    return points;
}

FittedCurve smooth_points(CurvePoints& points, bool closed) {
    double end = set_parameters(points, points.p, closed);
    if (!(end > 0)) {
        throw InputError("fit: the seam has no length; all its points coincide; check the scan");
    }
    const Loose loose = drop_outliers(points, breaks_at(points, end), closed);
    const std::vector<double> given = points.weight;
    end = set_parameters(points, loose.at, closed);
    std::vector<double> breaks = breaks_at(points, end);
    Smoothing s;
    s.lambda = loose_lambda(points, breaks);
    CubicBSpline curve;
    std::vector<CurveSigma> sigma;
    bool uneven = false;
    for (int round = 0; round < kFootRounds; ++round) {
        PenalisedSpline spline(breaks, closed);
        spline.take(points);
        choose_smoothing(spline, points, s, round, uneven);
        weigh(points, given, loose.bulge, project(points, spline.curve()), closed);
        curve = spline.curve();
        if (round + 1 == kFootRounds) {
            sigma = sigma_along(spline, s, points, given);
        } else {
            thin(breaks, s, spline);
            measure_along(points, breaks, curve);
        }
    }
    return {std::move(curve), s.freedom, std::move(sigma)};
}

}  // namespace seampath
