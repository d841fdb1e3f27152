#include "stages/geometry/border_section.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include <Eigen/Dense>

#include "stages/geometry/edge_witness.hpp"
#include "stages/geometry/lot.hpp"
#include "stages/geometry/robust.hpp"

namespace seampath {
namespace {

constexpr double kEdgeBand = 3;     // point distances beside an edge that tell nothing of the top's height: burrs
constexpr double kTurned = 0.1;     // slope of a top that the first guess does not know of
constexpr double kMostFull = 0.25;  // of the density of the tops, in the emptiest strip between them
constexpr double kShaded = 0.6;     // of the gap: so much lower a plate has its edge in the shadow of the other

// In the frame of the section: s along, u to the left of t, z along n; mm.
struct Point {
    double s, u, z;
    std::uint32_t view;
    std::uint32_t lot;
};

struct Frame {
    Eigen::Vector3d p, t, n, left;
    explicit Frame(const GapPlace& at) : p(at.p), t(at.t), n(at.n), left(at.n.cross(at.t)) {}
};

std::vector<Point> gather(const ViewedPoints& scan, const Frame& f, double along, double across, double height) {
    const Eigen::Vector3d half = along * f.t.cwiseAbs() + across * f.left.cwiseAbs() + height * f.n.cwiseAbs();
    std::vector<Point> points;
    const auto& starts = scan.view_starts;
    scan.grid.for_cells_in_box(f.p - half, f.p + half, [&](std::size_t cell) {
        const auto in_cell = scan.grid.points(cell);
        for (std::size_t i = 0; i < in_cell.size(); ++i) {
            const Eigen::Vector3d v = in_cell[i].cast<double>() - f.p;
            const Point q{v.dot(f.t), v.dot(f.left), v.dot(f.n), 0, lot_of(in_cell[i])};
            if (std::abs(q.s) <= along && std::abs(q.u) <= across && std::abs(q.z) <= height) {
                points.push_back(q);
                const auto source = scan.grid.source(scan.grid.first_point(cell) + i);
                points.back().view =
                    static_cast<std::uint32_t>(std::upper_bound(starts.begin(), starts.end(), source) - starts.begin());
            }
        }
    });
    return points;
}

struct Side {
    double side = 1;  // -1: plate 1, on the right
    Flank top;
    Edge edge;  // by its distance from the middle
};

// The line in which both edges run, u over s; the bend is taken over from the guess when the window is short.
struct Course {
    double middle = 0, slope = 0, bend = 0;
    double off(const Point& q) const { return q.u - middle - (slope + 0.5 * bend * q.s) * q.s; }
};

std::optional<Flank> fit_top(const std::vector<Point>& points, const ScanScale& scale, double side, double height,
                             const SectionWindow& window, double edge) {
    const double band = edge + kEdgeBand * scale.spacing;
    FlankPoints samples;
    for (const Point& q : points) {
        const double d = side * q.u;
        if (d >= band && d <= window.away &&
            std::abs(q.z - height) <= 4 * noise_of(scale) + scale.spacing + kTurned * (d - edge)) {
            samples.points.push_back({static_cast<float>(d), static_cast<float>(q.s), static_cast<float>(q.z), q.lot});
        }
    }
    thin_out(samples);
    auto top = fit_flank(samples, scale, {window.along, window.away, band});
    if (top) {
        settle_flank(*top, scale);
        finish_flank(*top, scale, edge);
    }
    return top;
}

// Where the gap is emptiest of points of the tops: the middle of the places where a strip holds least. Counting points
// to one side or the other needs it, and in a gap hardly wider than the points are apart a guess will not do.
struct Emptiest {
    double middle = 0;
    double share = 0;  // of the points that a strip of the sparser top as wide would hold
};
Emptiest emptiest(const std::vector<Point>& points, const std::array<Side, 2>& sides, const Course& course, double gap,
                  const ScanScale& scale) {
    constexpr int kSteps = 60;
    const double strip = std::max(0.5 * gap, scale.spacing), reach = 0.5 * gap + 2 * scale.spacing;
    std::vector<double> u;
    double beside[2] = {0, 0};  // on the tops, in two such strips
    for (const Point& q : points) {
        const double off = course.off(q);
        const auto on = [&](const Side& side) {
            return std::abs(residual(side.top, side.side * q.u, q.s, q.z)) <= kTopGate * side.top.noise;
        };
        if (std::abs(off) <= reach + strip && (on(sides[0]) || on(sides[1]))) {
            u.push_back(off);
        } else if (std::abs(off) > reach + strip && std::abs(off) <= reach + 3 * strip) {
            beside[off < 0 ? 0 : 1] += on(sides[off < 0 ? 0 : 1]);
        }
    }
    std::sort(u.begin(), u.end());
    std::array<double, kSteps + 1> count{};
    double least = std::numeric_limits<double>::max();
    const auto centre = [&](int i) { return reach * (2.0 * i / kSteps - 1); };
    for (int i = 0; i <= kSteps; ++i) {
        const double c = centre(i);
        count[static_cast<std::size_t>(i)] = static_cast<double>(std::upper_bound(u.begin(), u.end(), c + strip / 2) -
                                                                 std::lower_bound(u.begin(), u.end(), c - strip / 2));
        least = std::min(least, count[static_cast<std::size_t>(i)]);
    }
    double sum = 0, weights = 0;
    for (int i = 0; i <= kSteps; ++i) {
        const double w = std::exp(-(count[static_cast<std::size_t>(i)] - least) / std::sqrt(1 + least));
        sum += w * centre(i);
        weights += w;
    }
    return {course.middle + sum / weights, 2 * least / std::max(1.0, std::min(beside[0], beside[1]))};
}

// The points of one side, and those that may hang from it up to `over` mm beyond the middle.
std::vector<EdgePoint> points_beside(const std::vector<Point>& points, const Side& side, const Course& course,
                                     double over) {
    std::vector<EdgePoint> own;
    for (const Point& q : points) {
        const double d = side.side * course.off(q);
        if (d > -over) {
            own.push_back({q.s, d, residual(side.top, side.side * q.u, q.s, q.z), q.view});
        }
    }
    return own;
}

// By what the witnesses saw, edges turn and bend together.
void turn_with(const std::array<Side, 2>& sides, bool bends, Course& course) {
    Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
    Eigen::Vector4d b = Eigen::Vector4d::Zero();
    for (std::size_t k = 0; k < 2; ++k) {
        for (const EdgeOff& o : sides[k].edge.offs) {
            const Eigen::Vector4d row(k == 0, k == 1, o.s, bends ? o.s * o.s / 2 : 0);
            A += o.weight * row * row.transpose();
            b += o.weight * sides[k].side * o.off * row;
        }
    }
    A += 1e-9 * A.trace() * Eigen::Matrix4d::Identity();
    const Eigen::Vector4d x = A.ldlt().solve(b);
    course.slope += x[2];
    course.bend += x[3];
}

double shift_variance(const std::array<Side, 2>& sides, const std::array<double, 2>& sign) {
    std::map<std::uint32_t, double> share;
    for (std::size_t k = 0; k < 2; ++k) {
        for (const Witness& w : sides[k].edge.witnesses) {
            share[w.view] += sign[k] * w.share;
        }
    }
    double squares = 0;
    for (const auto& [view, x] : share) {
        squares += x * x;
    }
    return squares;
}

// What each view's points are off both tops.
std::map<std::uint32_t, GapFit::ViewOff> views_of(const std::vector<Point>& points, const std::array<Side, 2>& sides) {
    std::map<std::uint32_t, GapFit::ViewOff> views;
    for (const Point& q : points) {
        const Side& side = sides[q.u < 0 ? 0 : 1];
        const double d = side.side * q.u, off = residual(side.top, d, q.s, q.z);
        if (d >= side.top.window.band && d <= side.top.window.away && std::abs(off) <= kTopGate * side.top.noise) {
            views[q.view].sum += off;
            views[q.view].count += 1;
        }
    }
    return views;
}

// Variance of heights per variance of the views' shifts: squares of the views' shares of the points.
double height_shift(const std::map<std::uint32_t, GapFit::ViewOff>& views) {
    double squares = 0, all = 0;
    for (const auto& [view, off] : views) {
        squares += off.count * off.count;
        all += off.count;
    }
    return all > 0 ? squares / (all * all) : 1;
}

GapFit result_of(const Frame& f, const std::array<Side, 2>& sides, const Course& course,
                 const std::vector<Point>& points) {
    const double u[2] = {course.middle - sides[0].edge.distance, course.middle + sides[1].edge.distance},
                 z[2] = {sides[0].top.height, sides[1].top.height};
    GapFit fit;
    Eigen::Vector3d normal[2];
    for (std::size_t k = 0; k < 2; ++k) {
        const Flank& top = sides[k].top;
        normal[k] = (f.n - sides[k].side * top.slope * f.left - top.slope_along * f.t).normalized();
        fit.support[k] = top.slab_points;
        fit.walled[k] = sides[k].edge.walled;
    }
    fit.n1 = normal[0], fit.n2 = normal[1];
    fit.place.p = f.p + 0.5 * (u[0] + u[1]) * f.left + 0.5 * (z[0] + z[1]) * f.n;
    const Eigen::Vector3d mean = (normal[0] + normal[1]).normalized(), along = f.t + course.slope * f.left;
    fit.place.t = (along - along.dot(mean) * mean).normalized();
    fit.place.n = mean;
    fit.place.gap = u[1] - u[0];
    fit.place.mismatch = z[1] - z[0];
    fit.place.bend = course.bend;
    const double across = std::sqrt(sides[0].edge.variance + sides[1].edge.variance),
                 upright = std::hypot(sides[0].top.sigma, sides[1].top.sigma);
    fit.gap = {fit.place.gap, across};
    fit.mismatch = {fit.place.mismatch, upright};
    fit.sigma = 0.5 * std::hypot(across, upright);
    fit.views = views_of(points, sides);
    fit.shift = shift_variance(sides, {0.5, -0.5}) + height_shift(fit.views);
    return fit;
}

}  // namespace

std::optional<GapPlace> find_gap(const ViewedPoints& scan, const ScanScale& scale, const GapPlace& without_gap,
                                 double along) {
    constexpr std::size_t kLeast = 20;
    const Frame f(without_gap);
    const double inner = 0.5 * kMostGap + scale.spacing, outer = inner + 12 * scale.spacing;
    const std::vector<Point> points = gather(scan, f, along, outer, kMostMismatch);
    double height[2] = {0, 0}, edge[2] = {0, 0};
    for (std::size_t k = 0; k < 2; ++k) {
        const double side = k == 0 ? -1 : 1;
        std::vector<double> z;
        for (const Point& q : points) {
            if (side * q.u > inner) {
                z.push_back(q.z);
            }
        }
        if (z.size() < kLeast) {
            return std::nullopt;
        }
        height[k] = quantile(z, 0.5);
        double beside = 0, beyond = 0;
        for (const Point& q : points) {
            const bool on = std::abs(q.z - height[k])<4 * noise_of(scale), own = side * q.u> 0;
            (side * q.u > inner ? beside : beyond) += on && own;
        }
        edge[k] = inner - (outer - inner) * beyond / std::max(1.0, beside);
    }
    GapPlace place = without_gap;
    place.gap = std::clamp(edge[0] + edge[1], scale.spacing, kMostGap);
    place.mismatch = height[1] - height[0];
    place.p += 0.5 * (edge[1] - edge[0]) * f.left + 0.5 * (height[0] + height[1]) * f.n;
    return place;
}

SectionWindow within_bend(SectionWindow window, double bend, const ScanScale& scale) {
    if (bend != 0) {
        const double reach = std::pow(8 * 0.2 * noise_of(scale) / std::pow(std::abs(bend), 3), 0.25);
        window.along = std::min(window.along, reach);
    }
    return window;
}

std::optional<GapFit> fit_gap(const ViewedPoints& scan, const ScanScale& scale, const GapPlace& guess,
                              const SectionWindow& window) {
    constexpr double kBendSeen = 25;  // point distances of half a window that tells bends
    const Frame f(guess);
    const double away = window.away + guess.gap / 2;
    const SectionWindow w{window.along, away, window.band};
    const double height = std::abs(guess.mismatch) / 2 + std::max(kWallDepth * scale.spacing, kTurned * away);
    const std::vector<Point> points = gather(scan, f, w.along, away, height);
    std::array<Side, 2> sides;
    Course course{0, 0, guess.bend};
    for (std::size_t k = 0; k < 2; ++k) {
        sides[k].side = k == 0 ? -1 : 1;
        sides[k].edge.distance = guess.gap / 2;
        auto top = fit_top(points, scale, sides[k].side, sides[k].side * guess.mismatch / 2, w, guess.gap / 2);
        if (!top) {
            return std::nullopt;
        }
        sides[k].top = std::move(*top);
    }
    const double mismatch = sides[1].top.height - sides[0].top.height;
    for (int round = 0; round < 3; ++round) {
        const Emptiest strip = emptiest(points, sides, course, guess.gap, scale);
        if (strip.share > kMostFull) {
            return std::nullopt;
        }
        course.middle = strip.middle;
        for (Side& side : sides) {
            const double above = side.side * mismatch;
            auto edge = find_edge(points_beside(points, side, course, guess.gap / 2 + 3 * scale.spacing),
                                  {side.edge.distance, side.top.noise, scale.spacing, w.along, side.top.window.away,
                                   std::max(0.0, above), -above > kShaded * guess.gap});
            if (!edge) {
                return std::nullopt;
            }
            side.edge = std::move(*edge);
        }
        turn_with(sides, w.along > kBendSeen * scale.spacing, course);
    }
    for (Side& side : sides) {
        finish_flank(side.top, scale, side.edge.distance + side.side * course.middle);
    }
    GapFit fit = result_of(f, sides, course, points);
    return fit.place.p.allFinite() && fit.place.t.dot(guess.t) > 0.7 ? std::optional(fit) : std::nullopt;
}

std::optional<GapFit> settle_gap(const ViewedPoints& scan, const ScanScale& scale, const GapPlace& guess,
                                 const SectionWindow& window, int rounds) {
    auto fit = fit_gap(scan, scale, guess, window);
    for (int round = 1; round < rounds && fit; ++round) {
        const Eigen::Vector3d before = fit->place.p;
        fit = fit_gap(scan, scale, fit->place, window);
        if (fit && (fit->place.p - before).norm() < 0.1 * fit->sigma) {
            break;
        }
    }
    return fit;
}

}  // namespace seampath
