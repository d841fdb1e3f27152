#include "stages/geometry/curve_sigma.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "stages/geometry/bspline.hpp"
#include "stages/geometry/robust.hpp"

namespace seampath {
namespace {

// What of the stated variance the points do not show. Within chance nothing is missing.
double unseen_share(double seen, double freedom_left) {
    constexpr double kChance = 4.3;  // three sigma of a median's square, over the root of the number
    return seen < 1 - kChance / std::sqrt(std::max(freedom_left, 1.0)) ? 1 - seen : 0;
}

// The stated variances along the curve, and how much of them the points show.
struct Stated {
    std::vector<std::pair<double, double>> variance;  // parameter and variance of the points that count
    double seen = 0, unseen = 0;

    Stated(const PenalisedSpline& spline, const Smoothing& s, const CurvePoints& points,
           const std::vector<double>& given) {
        std::vector<double> off;
        for (std::size_t i = 0; i < points.p.size(); ++i) {
            if (points.weight[i] > 0) {
                variance.emplace_back(points.u[i], 1 / given[i]);
                off.push_back((spline.at_point(i) - points.p[i]).norm() * std::sqrt(given[i]));
            }
        }
        std::sort(variance.begin(), variance.end());
        // Of distances in the plane the median's square is ln 2 of the mean square, and outliers don't touch it.
        const auto used = static_cast<double>(off.size());
        const double left = std::max(used - s.freedom, 1e-3 * used);
        seen = std::pow(quantile(off, 0.5), 2) / std::numbers::ln2 * used / left;
        unseen = unseen_share(seen, left);
    }

    double at(double u) const {
        return std::lower_bound(variance.begin(), std::prev(variance.end()), std::pair(u, 0.0))->second;
    }
};

PenalisedSpline solved_with(PenalisedSpline spline, std::vector<double> lambda, double factor) {
    for (double& l : lambda) {
        l *= factor;
    }
    spline.solve(lambda);
    return spline;
}

}  // namespace

std::vector<CurveSigma> sigma_along(const PenalisedSpline& spline, const Smoothing& s, const CurvePoints& points,
                                    const std::vector<double>& given) {
    constexpr double kStep = 0.02;  // of a central difference for log lambda; wrong by a ten thousandth
    constexpr double kLooser = 4;   // sees four fifths of the bias of a wave of which the curve has half
    const Stated stated(spline, s, points, given);
    const PenalisedSpline stiffer = solved_with(spline, s.lambda, 1 + kStep),
                          softer = solved_with(spline, s.lambda, 1 - kStep),
                          loose = solved_with(spline, s.lambda, 1 / kLooser);
    std::vector<CurveSigma> sigma;
    const auto add = [&](double u) {
        // (N + P)^-1 N (N + P)^-1 is (N + P)^-1 and its derivative for log lambda.
        const double noise = spline.variance(u) + (stiffer.variance(u) - softer.variance(u)) / (2 * kStep);
        const Eigen::Vector3d t = tangent(spline.curve(), u);
        const Eigen::Vector3d apart = position(loose.curve(), u) - position(spline.curve(), u);
        const Eigen::Vector3d bias = kLooser / (kLooser - 1) * (apart - apart.dot(t) * t);
        // Distances are of two directions: each has half of the variance.
        sigma.push_back(
            {u, std::sqrt(0.5 * (stated.seen * noise + bias.squaredNorm() + stated.unseen * stated.at(u)))});
    };
    const std::vector<double>& breaks = spline.breaks();
    for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
        add(breaks[k]);
        add(0.5 * (breaks[k] + breaks[k + 1]));
    }
    if (!spline.curve().periodic) {
        add(breaks.back());
    }
    return sigma;
}

}  // namespace seampath
