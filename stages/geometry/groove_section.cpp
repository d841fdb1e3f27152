#include "stages/geometry/groove_section.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "stages/geometry/groove_turn.hpp"

namespace seampath {
namespace {

using Eigen::Vector2d;

constexpr double kGate = 4;           // noises
constexpr double kMostPoints = 1200;  // of a face: more add time and, their noise being shared, nothing to the fit
constexpr double kRoughly = 300;      // of them tell where to look
constexpr std::size_t kFewestInSection = 30;
constexpr double kDeepest = 80;  // mm along a bevel
constexpr double kWedge = 0.12;  // slope by which the guess may be off

Vector2d normal_of(const Vector2d& d, int side) {
    return side == 0 ? Vector2d(d[1], -d[0]) : Vector2d(-d[1], d[0]);
}

GrooveFace line(const Vector2d& o, const Vector2d& d, int side) {
    GrooveFace face;
    face.o = o;
    face.d = d;
    face.n = normal_of(d, side);
    return face;
}

/// Which points are a face's: u from low to high, and within the gate, which opens by `wedge` per mm from `u0`.
struct Gate {
    double low, high, width, wedge = 0, u0 = 0;
    bool holds(double u, double off) const {
        return u >= low && u <= high && std::abs(off) <= width + wedge * std::abs(u - u0);
    }
};

struct FacePoint {
    double u, s, z;
    std::uint32_t view;
};

// Carried back along `drift`; `own` says of a point (a, h) whether it can be this face's at all.
template <class Own>
std::vector<FacePoint> points_of(std::span<const GroovePoint> points, const Vector2d& drift, const GrooveFace& face,
                                 const Gate& gate, Own&& own) {
    std::vector<FacePoint> taken;
    for (const GroovePoint& q : points) {
        const Vector2d x = q.section(drift);
        const double u = face.along(x);
        if (gate.holds(u, face.off(x)) && own(x)) {
            taken.push_back({u, q.s, face.n.dot(x - face.o), q.view});
        }
    }
    return taken;
}

bool fit(GrooveFace& face, const std::vector<FacePoint>& points, const Vector2d& drift, double along, double most,
         const ScanScale& scale) {
    if (points.size() < kFewestInSection) {
        return false;
    }
    double length = 0;
    for (const FacePoint& x : points) {
        length = std::max(length, std::abs(x.u));
    }
    const auto stride = 1 + static_cast<std::size_t>(static_cast<double>(points.size()) / most);
    QuadraticFit quadric;
    quadric.begin(points.size() / stride + 1, length, along);
    for (std::size_t i = 0; i < points.size(); i += stride) {
        quadric.add(points[i].u / length, points[i].s / along, points[i].z);
    }
    if (!quadric.solve(0.3 * scale.noise)) {
        return false;
    }
    const double unit = quadric.scale() * std::sqrt(1 + (scale.correlation - 1) / static_cast<double>(stride));
    quadric.shrink(unit);
    const auto& c = quadric.coefficients();
    const QuadraticFit::Normal cofactors = quadric.cofactors();
    constexpr int kOfSection[3] = {0, 1, 3};
    Eigen::Matrix<double, 3, 6> pick = Eigen::Matrix<double, 3, 6>::Zero();
    for (int i = 0; i < 3; ++i) {
        pick(i, kOfSection[i]) = 1;
    }
    face.length = length;
    face.c = pick * c;
    face.covariance = unit * unit * pick * cofactors * pick.transpose();
    face.slope_along = c[2] / along + face.gradient().dot(drift);
    face.scale = quadric.scale();
    face.shift.clear();
    for (std::size_t i = 0; i < quadric.size(); ++i) {
        const std::uint32_t view = points[i * stride].view;
        if (view >= face.shift.size()) {
            face.shift.resize(view + 1, Eigen::Vector3d::Zero());
        }
        face.shift[view] += quadric.weight(i) * pick * cofactors * QuadraticFit::row(quadric.u(i), quadric.s(i));
    }
    return true;
}

// Along the first face, where its line runs into the second's; straight lines through the faces' own origins.
double crossing(const GrooveFace& a, const GrooveFace& b) {
    const Vector2d da = a.tangent(0), db = b.tangent(0), oa = a.at(0);
    const double sine = cross(da, db);
    return std::abs(sine) < 1e-6 ? -1e9 : cross(b.at(0) - oa, db) / sine;
}

// Of what views see of one end, the mean of those that see as far as the one that sees furthest, weighted by how sure
// they are; and the share of each view in it. Empty when none sees it.
std::optional<std::pair<DensityEdge, std::vector<double>>> furthest(
    const std::vector<std::optional<DensityEdge>>& seen) {
    constexpr double kAsFar = 2.5;   // sigmas
    constexpr double kLeast = 0.08;  // of the densest view's density
    std::vector<double> share(seen.size(), 0);
    const DensityEdge* first = nullptr;
    double densest = 0;
    for (const auto& edge : seen) {
        densest = std::max(densest, edge ? edge->density : 0);
    }
    for (const auto& edge : seen) {
        if (edge && edge->density > kLeast * densest && (!first || edge->at - edge->sigma > first->at - first->sigma)) {
            first = &*edge;
        }
    }
    if (!first) {
        return std::nullopt;
    }
    DensityEdge mean{0, 0, 0, 0};
    double weights = 0;
    for (std::size_t v = 0; v < seen.size(); ++v) {
        if (seen[v] && seen[v]->density > kLeast * densest &&
            first->at - seen[v]->at < kAsFar * std::hypot(first->sigma, seen[v]->sigma)) {
            share[v] = 1 / (seen[v]->sigma * seen[v]->sigma);
            weights += share[v];
            mean.at += share[v] * seen[v]->at;
            mean.blur += share[v] * seen[v]->blur;
            mean.density += seen[v]->density;
        }
    }
    for (double& x : share) {
        x /= weights;
    }
    mean.at /= weights;
    mean.blur /= weights;
    mean.sigma = 1 / std::sqrt(weights);
    return std::pair(mean, share);
}

/// A section in the making.
struct Work {
    std::span<const GroovePoint> points;
    ScanScale scale;
    GrooveWindow window;
    GrooveFit fit;
    std::array<Vector2d, 2> drift{Vector2d::Zero(), Vector2d::Zero()};  // of each side, mm per mm along the groove
    double most = kMostPoints;

    double along() const { return std::max(window.back, window.ahead); }
    double gate_width() const { return kGate * scale.noise; }

    // Nearer to this side's bevel than to the other's.
    auto own(int k) const {
        return
            [this, k](const Vector2d& x) { return std::abs(fit.bevel[k].off(x)) <= std::abs(fit.bevel[1 - k].off(x)); };
    }

    // The bevel's points near its corner; `reach` of it.
    bool fit_bevel(int k, double low, double high, double wedge) {
        GrooveFace& face = fit.bevel[static_cast<std::size_t>(k)];
        const double corner = face.along(fit.shape.corner[static_cast<std::size_t>(k)]);
        const Gate gate{low, high, gate_width() + (wedge > 0 ? scale.spacing : 0), wedge, corner};
        return fit_face(k, face, gate, own(k));
    }

    bool fit_top(int k, double wedge) {
        GrooveFace& face = fit.top[static_cast<std::size_t>(k)];
        const double corner = face.along(fit.shape.corner[static_cast<std::size_t>(k)]);
        const Gate gate{corner + window.band, corner + window.away, gate_width() + (wedge > 0 ? scale.spacing : 0),
                        wedge, 0};
        return fit_face(k, face, gate, [](const Vector2d&) { return true; });
    }

    template <class Own>
    bool fit_face(int k, GrooveFace& face, const Gate& gate, Own&& own) {
        const Vector2d& with = drift[static_cast<std::size_t>(k)];
        return seampath::fit(face, points_of(points, with, face, gate, own), with, along(), most, scale);
    }

    // Along -d, so that the bevel's points lie before their end; view by view: a view may be shadowed where another
    // sees on.
    std::optional<std::pair<DensityEdge, std::vector<double>>> find_end(int k, double from) {
        const auto side = static_cast<std::size_t>(k);
        const GrooveFace& face = fit.bevel[side];
        const Gate gate{-kDeepest, face.along(fit.shape.corner[side]), gate_width(), 0.02, from};
        std::vector<std::vector<double>> x;
        const auto nearer = own(k);
        // What lies on the other plate's root face, or behind it, is none of this bevel's.
        const bool faced = fit.seen[1 - side] && fit.seen[1 - side]->turns;
        const Vector2d other = fit.shape.end[1 - side], behind = fit.top[1 - side].tangent(0);
        const auto here = [&](const Vector2d& q) {
            return nearer(q) && !(faced && (q - other).dot(behind) > -gate_width());
        };
        for (const FacePoint& q : points_of(points, drift[side], face, gate, here)) {
            x.resize(std::max<std::size_t>(x.size(), q.view + 1));
            x[q.view].push_back(-q.u);
        }
        std::vector<std::optional<DensityEdge>> seen;
        for (auto& of_view : x) {
            seen.push_back(density_edge(std::move(of_view), -from, scale.spacing, scale.noise));
        }
        return furthest(seen);
    }

    void settle_end(std::size_t side, double from) {
        const auto end = find_end(static_cast<int>(side), from);
        fit.seen[side] = std::nullopt;
        if (!end) {
            return;
        }
        const auto& [edge, share] = *end;
        const Vector2d corner = fit.shape.corner[side], down = fit.bevel[side].at(-edge.at) - corner;
        const double depth = std::abs(cross(fit.top[side].tangent(0), down));
        fit.seen[side] = bevel_turn(points, drift[side], fit, side, corner + down, scale, gate_width())
                             .value_or(BevelDepth{depth, edge.sigma * depth / down.norm(), {}});
        fit.shape.end[side] = corner + fit.seen[side]->depth / depth * down;
        fit.seen[side]->sigma = std::hypot(fit.seen[side]->sigma, std::sqrt(fit.top[side].covariance(0, 0)));
        fit.seen[side]->share = share;
    }

    void set_corners() {
        for (std::size_t k = 0; k < 2; ++k) {
            Eigen::Matrix2d gradients;
            gradients << fit.bevel[k].gradient().transpose(), fit.top[k].gradient().transpose();
            const Vector2d found = gradients.inverse() * Vector2d(fit.bevel[k].slope_along, fit.top[k].slope_along);
            drift[k] = found.norm() < kWedge ? found : Vector2d(0, 0);
            fit.shape.corner[k] = fit.bevel[k].at(crossing(fit.bevel[k], fit.top[k]));
            fit.shape.out[k] = fit.top[k].tangent(0);
        }
    }
};

}  // namespace

Vector2d GrooveFace::at(double u) const {
    const double x = u / length;
    return o + u * d + (c[0] + c[1] * x + c[2] * x * x) * n;
}

Vector2d GrooveFace::tangent(double u) const {
    return (d + (c[1] + 2 * c[2] * u / length) / length * n).normalized();
}

double GrooveFace::off(const Vector2d& x) const {
    const double u = along(x) / length;
    return n.dot(x - o) - (c[0] + c[1] * u + c[2] * u * u);
}

GrooveWindow groove_window(const SectionWindow& window) {
    return {window.along, window.along, window.away, window.band};
}

GrooveWindow near_ends(const GrooveWindow& window, double to_begin, double to_end) {
    GrooveWindow w = window;
    w.back = std::min(window.back, to_begin) + std::max(0.0, window.ahead - to_end);
    w.ahead = std::min(window.ahead, to_end) + std::max(0.0, window.back - to_begin);
    return w;
}

std::optional<GrooveFit> fit_groove(const PointGrid& grid, std::span<const std::size_t> view_starts,
                                    const ScanScale& scale, const GrooveFrame& frame, const GrooveShape& guess,
                                    const GrooveWindow& window, int rounds) {
    GrooveBox box{guess.corner[0], guess.corner[0]};
    const double width = (guess.corner[0] - guess.corner[1]).norm();
    const Vector2d d0 = (guess.end[0] - guess.corner[0]).normalized(),
                   d1 = (guess.end[1] - guess.corner[1]).normalized();
    const double runs =
        std::abs(cross(d0, d1)) < 0.1 ? 0 : cross(guess.corner[1] - guess.corner[0], d1) / cross(d0, d1);
    const double deep = runs > 0 ? std::min(kDeepest, 1.3 * runs + 3) : std::min(kDeepest, 3 * width + 10);
    for (int k = 0; k < 2; ++k) {
        const auto side = static_cast<std::size_t>(k);
        for (const Vector2d& x :
             {guess.corner[side], guess.end[side], Vector2d(guess.corner[side] + window.away * guess.out[side])}) {
            box.low = box.low.cwiseMin(x);
            box.high = box.high.cwiseMax(x);
        }
    }
    box.low = (box.low - Vector2d(2, 2)).cwiseMin(guess.corner[0] - Vector2d(0, deep));
    box.high += Vector2d(2, 2);
    const auto points = groove_points(grid, view_starts, frame, -window.back, window.ahead, box);
    Work work{points, scale, window, {}};
    GrooveFit& fit = work.fit;
    fit.shape = guess;
    for (int k = 0; k < 2; ++k) {
        const auto side = static_cast<std::size_t>(k);
        const Vector2d d = (guess.corner[side] - guess.end[side]).normalized();
        fit.bevel[side] = line(guess.end[side], d, k);
        fit.top[side] = line(guess.corner[side], guess.out[side], k);
    }
    for (int round = 0; round < rounds; ++round) {
        const double wedge = round == 0 ? kWedge : 0;
        work.most = round + 1 < rounds ? kRoughly : kMostPoints;
        std::array<double, 2> low{0, 0}, high{0, 0};
        for (std::size_t k = 0; k < 2; ++k) {
            const double from = round == 0 ? 0 : fit.bevel[k].along(fit.shape.end[k]),
                         to = fit.bevel[k].along(fit.shape.corner[k]);
            low[k] = from + (round == 0 ? 0 : std::min(0.5 * window.band, 0.2 * (to - from)));
            high[k] = to - std::min(window.band, 0.3 * (to - from));
        }
        for (int k = 0; k < 2; ++k) {
            const auto side = static_cast<std::size_t>(k);
            if (!work.fit_top(k, wedge) || !work.fit_bevel(k, low[side], high[side], wedge)) {
                return std::nullopt;
            }
        }
        work.set_corners();
        for (int k = 0; k < 2; ++k) {
            const auto side = static_cast<std::size_t>(k);
            const double corner = fit.bevel[side].along(fit.shape.corner[side]);
            work.settle_end(side, corner - 0.6 * (corner - low[side]));
        }
    }
    for (std::size_t k = 0; k < 2; ++k) {
        const double length = (fit.shape.corner[k] - fit.shape.end[k]).norm();
        const double half = std::min({window.back, window.ahead, std::max(2.5 * scale.spacing, work.along() / 8)});
        const double end = fit.bevel[k].along(fit.shape.end[k]);
        const Gate gate{end, end + length, work.gate_width()};
        double count = 0;
        for (const GroovePoint& q : points) {
            const Vector2d x = q.section(work.drift[k]);
            count += std::abs(q.s) <= half && gate.holds(fit.bevel[k].along(x), fit.bevel[k].off(x));
        }
        fit.density[k] = count / (2 * half * std::max(length, scale.spacing));
    }
    return fit;
}

}  // namespace seampath
