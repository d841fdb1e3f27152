#include "stages/stripe/lines.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stages/geometry/robust.hpp"

namespace seampath {
namespace {

using Eigen::Vector2d;

/// Sums over points, from which the least squares line of any run of them follows.
struct LineSums {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;

    void add(const Vector2d& p, double w) {
        n += w, x += w * p.x(), y += w * p.y();
        xx += w * p.x() * p.x(), xy += w * p.x() * p.y(), yy += w * p.y() * p.y();
    }
    LineSums operator-(const LineSums& o) const { return {n - o.n, x - o.x, y - o.y, xx - o.xx, xy - o.xy, yy - o.yy}; }
    Vector2d middle() const { return {x / n, y / n}; }

    /// Scatter about the middle: its half difference, its product, its half sum.
    struct Scatter {
        double half, product, sum;
        double root() const { return std::hypot(half, product); }
    };
    Scatter scatter() const {
        const double sxx = xx - x * x / n, sxy = xy - x * y / n, syy = yy - y * y / n;
        return {0.5 * (sxx - syy), sxy, 0.5 * (sxx + syy)};
    }
    /// Sum of squared distances from the line.
    double rest() const {
        const Scatter s = scatter();
        return std::max(0.0, s.sum - s.root());
    }
    Vector2d direction() const {
        const Scatter s = scatter();
        const double angle = 0.5 * std::atan2(s.product, s.half);
        return {std::cos(angle), std::sin(angle)};
    }
};

/// Places where the profile may be cut, as indices of points, and the sums up to each.
struct Cuts {
    std::vector<std::size_t> at;
    std::vector<LineSums> sums;
};

Cuts possible_cuts(std::span<const Vector2d> points) {
    constexpr std::size_t kMostCuts = 160;  // the search takes their square
    const std::size_t step = std::max<std::size_t>(1, points.size() / kMostCuts);
    Cuts cuts;
    LineSums sums;
    const Vector2d& origin = points[points.size() / 2];
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (i % step == 0) {
            cuts.at.push_back(i);
            cuts.sums.push_back(sums);
        }
        sums.add(points[i] - origin, 1);
    }
    cuts.at.push_back(points.size());
    cuts.sums.push_back(sums);
    return cuts;
}

/// Indices of points between which the pieces lie, from the first to one behind the last.
std::vector<std::size_t> best_cuts(std::span<const Vector2d> points, double variance, double charge) {
    const Cuts cuts = possible_cuts(points);
    const std::size_t n = cuts.at.size();
    std::vector<double> cost(n, std::numeric_limits<double>::infinity());
    std::vector<std::size_t> before(n, 0);
    cost[0] = 0;
    for (std::size_t j = 1; j < n; ++j) {
        for (std::size_t i = 0; i < j; ++i) {
            const double here = cost[i] + (cuts.sums[j] - cuts.sums[i]).rest() / variance + charge;
            if (here < cost[j]) {
                cost[j] = here;
                before[j] = i;
            }
        }
    }
    std::vector<std::size_t> chosen;
    for (std::size_t j = n - 1; j > 0; j = before[j]) {
        chosen.push_back(cuts.at[j]);
    }
    chosen.push_back(0);
    return {chosen.rbegin(), chosen.rend()};
}

/// The robust line of points [begin, end) but those within the band of either end; of no length when too few are left.
ProfileLine robust_line(std::span<const Vector2d> points, std::size_t begin, std::size_t end,
                        const ProfileScale& profile) {
    constexpr std::size_t kFewest = 8;
    constexpr double kTukeyLimit = 4.685;
    const Vector2d &first = points[begin], &last = points[end - 1];
    std::vector<Vector2d> inner;
    for (std::size_t i = begin; i < end; ++i) {
        if ((points[i] - first).norm() > profile.band && (points[i] - last).norm() > profile.band) {
            inner.push_back(points[i]);
        }
    }
    if (inner.size() < kFewest) {
        return {};
    }
    ProfileLine line;
    std::vector<double> weight(inner.size(), 1), distance(inner.size());
    LineSums sums;
    for (int round = 0; round < 6; ++round) {
        sums = {};
        for (std::size_t i = 0; i < inner.size(); ++i) {
            sums.add(inner[i] - first, weight[i]);
        }
        line.middle = first + sums.middle();
        line.direction = sums.direction();
        for (std::size_t i = 0; i < inner.size(); ++i) {
            distance[i] = std::abs(line.height(inner[i]));
        }
        std::vector<double> sorted = distance;
        const double scale = std::max(profile.sigma, 1.4826 * quantile(sorted, 0.5));
        for (std::size_t i = 0; i < inner.size(); ++i) {
            const double u = distance[i] / (kTukeyLimit * scale);
            weight[i] = u < 1 ? (1 - u * u) * (1 - u * u) : 0;
        }
    }
    line.direction *= line.direction.dot(last - first) < 0 ? -1 : 1;
    line.begin = begin, line.end = end;
    line.length = line.direction.dot(last - first);
    line.sigma = profile.sigma * std::sqrt(std::max(1.0, profile.correlated) / std::max(1.0, sums.n));
    return line;
}

}  // namespace

std::vector<ProfileLine> straight_pieces(std::span<const Vector2d> points, const ProfileScale& scale) {
    if (points.size() < 2) {
        return {};
    }
    // A cut adds a place and two numbers of a line. Errors that neighbours share count for so many more.
    const double charge = 3 * std::log(static_cast<double>(points.size()));
    const double variance = scale.sigma * scale.sigma * std::max(1.0, scale.correlated);
    const std::vector<std::size_t> cuts = best_cuts(points, variance, charge);
    std::vector<ProfileLine> lines;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        const ProfileLine line = robust_line(points, cuts[i], cuts[i + 1], scale);
        if (line.length > 0) {
            lines.push_back(line);
        }
    }
    return lines;
}

Vector2d meeting(const ProfileLine& a, const ProfileLine& b) {
    const Vector2d apart = b.middle - a.middle, &u = a.direction, &v = b.direction;
    return a.middle + (apart.x() * v.y() - apart.y() * v.x()) / (u.x() * v.y() - u.y() * v.x()) * u;
}

double turn(const ProfileLine& a, const ProfileLine& b) {
    return std::atan2(a.direction.x() * b.direction.y() - a.direction.y() * b.direction.x(),
                      a.direction.dot(b.direction));
}

}  // namespace seampath
