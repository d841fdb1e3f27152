#include "stages/geometry/outliers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "stages/geometry/arc.hpp"
#include "stages/geometry/robust.hpp"

namespace seampath {
namespace {

constexpr double kTukeyLimit = 4.685;
constexpr double kMedianToSigma = 1.2;  // of a distance in the plane (Rayleigh), to its root mean square

// Neighbours by index, round the ring when closed.
struct Row {
    std::ptrdiff_t n;
    bool closed;
    bool has(std::ptrdiff_t i) const { return closed || (i >= 0 && i < n); }
    std::size_t operator()(std::ptrdiff_t i) const {
        return static_cast<std::size_t>(closed ? (i + n) % n : std::clamp<std::ptrdiff_t>(i, 0, n - 1));
    }
};

// How far a curve that turns so bulges between the neighbours of a point (of an arc: length * turn / 8). The turn is
// that of twice the length: taken large.
double bulge_at(const std::vector<Eigen::Vector3d>& q, const Row& row, std::ptrdiff_t i) {
    constexpr std::ptrdiff_t kSpanned = 3;
    if (row.n <= 2 * kSpanned) {
        return 0;
    }
    i = row.closed ? i : std::clamp<std::ptrdiff_t>(i, kSpanned, row.n - 1 - kSpanned);
    const Eigen::Vector3d a = q[row(i - 1)] - q[row(i - 3)], b = q[row(i + 3)] - q[row(i + 1)];
    return (q[row(i + 1)] - q[row(i - 1)]).norm() * std::atan2(a.cross(b).norm(), a.dot(b)) / 8;
}

// How far a point is from what its neighbours say without a curve: the median distance from the chords between those
// before and those behind it that still count. Two points that are off side by side hold a loose curve, not the chords.
double off_chords(const CurvePoints& points, const Row& row, std::ptrdiff_t i) {
    constexpr std::size_t kEachSide = 6;
    std::vector<std::size_t> before, behind;
    for (std::ptrdiff_t k = 1; k < row.n && (before.size() < kEachSide || behind.size() < kEachSide); ++k) {
        if (before.size() < kEachSide && row.has(i - k) && points.weight[row(i - k)] > 0) {
            before.push_back(row(i - k));
        }
        if (behind.size() < kEachSide && row.has(i + k) && points.weight[row(i + k)] > 0) {
            behind.push_back(row(i + k));
        }
    }
    std::vector<double> distance;
    for (const std::size_t a : before) {
        for (const std::size_t b : behind) {
            distance.push_back(nearest_on_segment(points.p[row(i)], points.p[a], points.p[b]).distance_mm);
        }
    }
    return distance.empty() ? std::numeric_limits<double>::infinity() : quantile(distance, 0.5);
}

}  // namespace

Loose drop_outliers(CurvePoints& points, const std::vector<double>& breaks, bool closed) {
    constexpr int kDropRounds = 12;
    constexpr std::ptrdiff_t kPulled = 2;  // a point pulls the loose curve at its two neighbours on each side
    const Row row{static_cast<std::ptrdiff_t>(points.p.size()), closed};
    const std::vector<double> given = points.weight;
    PenalisedSpline spline(breaks, closed);
    std::vector<double> lambda = loose_lambda(points, breaks);
    std::vector<double> off(points.p.size());
    std::vector<Eigen::Vector3d> q(points.p.size());
    for (int round = 0; round < kDropRounds; ++round) {
        spline.take(points);
        spline.solve(lambda);
        std::vector<double> in;
        for (std::size_t i = 0; i < off.size(); ++i) {
            q[i] = spline.at_point(i);
            // r / (1 - h) is the distance from the curve without the point.
            off[i] = (q[i] - points.p[i]).norm() * std::sqrt(given[i]) / std::max(1 - spline.leverage(i), 0.01);
            if (points.weight[i] > 0) {
                in.push_back(off[i]);
            }
        }
        const double limit = kTukeyLimit * std::max(std::sqrt(2.0), kMedianToSigma * quantile(in, 0.5));
        for (std::ptrdiff_t i = 0; i < row.n; ++i) {
            const std::size_t at = row(i);
            if (points.weight[at] > 0 && off[at] > limit) {
                off[at] = std::min(off[at], off_chords(points, row, i) * std::sqrt(given[at]));
            }
        }
        std::vector<std::size_t> worst;
        for (std::ptrdiff_t i = 0; i < row.n; ++i) {
            const std::size_t at = row(i);
            bool is = points.weight[at] > 0 && off[at] > limit &&
                      off[at] > limit + bulge_at(q, row, i) * std::sqrt(given[at]);
            for (std::ptrdiff_t k = i - kPulled; is && k <= i + kPulled; ++k) {
                is = k == i || !row.has(k) || points.weight[row(k)] == 0 || off[row(k)] < off[at];
            }
            if (is) {
                worst.push_back(at);
            }
        }
        for (const std::size_t i : worst) {
            points.weight[i] = 0;
        }
        if (worst.empty()) {
            break;
        }
    }
    Loose loose{std::move(q), {}};
    for (std::ptrdiff_t i = 0; i < row.n; ++i) {
        loose.bulge.push_back(bulge_at(loose.at, row, i));
    }
    return loose;
}

void weigh(CurvePoints& points, const std::vector<double>& given, const std::vector<double>& bulge,
           const std::vector<Eigen::Vector3d>& off_curve, bool closed) {
    constexpr std::ptrdiff_t kNear = 3;
    const Row row{static_cast<std::ptrdiff_t>(points.p.size()), closed};
    std::vector<double> off;
    for (std::size_t i = 0; i < given.size(); ++i) {
        off.push_back(off_curve[i].norm() * std::sqrt(given[i]));
    }
    const double scale = std::max(1.0, kMedianToSigma * quantile(off, 0.5));
    const std::vector<double> before = points.weight;
    std::vector<double> same_side;
    for (std::ptrdiff_t i = 0; i < row.n; ++i) {
        // Where the neighbours are off to the same side, the curve is off: only what goes beyond them is the point's.
        const Eigen::Vector3d& r = off_curve[row(i)];
        same_side.clear();
        for (std::ptrdiff_t k = i - kNear; k <= i + kNear; ++k) {
            if (k != i && row.has(k) && before[row(k)] > 0) {
                same_side.push_back(off_curve[row(k)].dot(r) / std::max(r.norm(), 1e-300));
            }
        }
        const double excess = r.norm() - std::max(0.0, quantile(same_side, 0.5)) - bulge[row(i)];
        const double x = std::max(0.0, excess) * std::sqrt(given[row(i)]) / (kTukeyLimit * scale);
        points.weight[row(i)] = x < 1 ? given[row(i)] * (1 - x * x) * (1 - x * x) : 0;
    }
}

}  // namespace seampath
