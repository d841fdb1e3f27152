#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "stages/geometry/groove_section.hpp"

namespace seampath {
namespace {

using Eigen::Vector2d;
using Numbers = GrooveNumbers::Vector;

enum Number { kRootA, kRootH, kGap, kMismatch, kBevel1, kBevel2, kIncluded, kDepth, kArea };

/// Where two faces' lines meet: Newton's method on both distances along them.
Vector2d meet(const GrooveFace& f, const GrooveFace& g) {
    double u = 0, v = 0;
    for (int i = 0; i < 20; ++i) {
        const Vector2d gap = f.at(u) - g.at(v), tf = f.tangent(u), tg = g.tangent(v);
        const double sine = cross(tf, tg);
        if (std::abs(sine) < 1e-9) {
            break;
        }
        const double du = -cross(gap, tg) / sine, dv = -cross(gap, tf) / sine;
        // Along the tangents, of which d is a part.
        u += du * tf.dot(f.d);
        v += dv * tg.dot(g.d);
        if (std::abs(du) + std::abs(dv) < 1e-12) {
            break;
        }
    }
    return f.at(u);
}

/// The place of a face's line that lies `depth` below x, along `up`.
Vector2d at_depth(const GrooveFace& face, const Vector2d& x, const Vector2d& up, double depth) {
    double u = face.along(x - depth * up);
    for (int i = 0; i < 20; ++i) {
        const double climbs = up.dot(face.tangent(u));
        const double step = (up.dot(x - face.at(u)) - depth) / (std::abs(climbs) < 1e-3 ? 1e-3 : climbs);
        u += step * face.tangent(u).dot(face.d);
        if (std::abs(step) < 1e-12) {
            break;
        }
    }
    return face.at(u);
}

Vector2d normal_at(const GrooveFace& face, const Vector2d& x) {
    const Vector2d t = face.tangent(face.along(x));
    const Vector2d n(-t[1], t[0]);
    return n.dot(face.n) < 0 ? Vector2d(-n) : n;
}

struct Ends {
    std::array<Vector2d, 2> corner, end, top_normal;
    Vector2d up;
};

Ends ends_of(const GrooveFit& fit, const GrooveRoot& root) {
    Ends e;
    for (std::size_t k = 0; k < 2; ++k) {
        e.corner[k] = meet(fit.bevel[k], fit.top[k]);
        e.top_normal[k] = normal_at(fit.top[k], e.corner[k]);
        e.end[k] = at_depth(fit.bevel[k], e.corner[k], e.top_normal[k], fit.lower[k].depth);
    }
    e.up = (e.top_normal[0] + e.top_normal[1]).normalized();
    if (root.closed) {
        e.end[0] = e.end[1] = meet(fit.bevel[0], fit.bevel[1]);
    } else if (root.square) {
        const auto q = static_cast<std::size_t>(*root.square);
        e.end[q] = at_depth(fit.bevel[q], e.end[1 - q], e.up, 0);
    }
    return e;
}

Numbers values_of(const GrooveFit& fit, const GrooveRoot& root) {
    const Ends e = ends_of(fit, root);
    const Vector2d across(e.up[1], -e.up[0]), middle = 0.5 * (e.end[0] + e.end[1]);
    std::array<Vector2d, 2> tangent;
    std::array<double, 2> bevel, depth;
    for (std::size_t k = 0; k < 2; ++k) {
        const double half = 0.5 * (fit.bevel[k].along(e.corner[k]) + fit.bevel[k].along(e.end[k]));
        tangent[k] = fit.bevel[k].tangent(half);
        bevel[k] = bevel_angle(fit, k, half);
        depth[k] = (e.corner[k] - e.end[k]).dot(e.top_normal[k]);
    }
    Numbers v;
    v[kRootA] = middle[0];
    v[kRootH] = middle[1];
    v[kGap] = (e.end[1] - e.end[0]).dot(across);
    v[kMismatch] = (e.corner[1] - e.corner[0]).dot(e.up);
    v[kBevel1] = bevel[0];
    v[kBevel2] = bevel[1];
    v[kIncluded] = std::atan2(cross(tangent[1], tangent[0]), tangent[0].dot(tangent[1]));
    v[kDepth] = root.square ? depth[static_cast<std::size_t>(1 - *root.square)] : 0.5 * (depth[0] + depth[1]);
    v[kArea] = 0.5 * (cross(e.end[1] - e.end[0], e.corner[1] - e.end[0]) +
                      cross(e.corner[1] - e.end[0], e.corner[0] - e.end[0]));
    return v;
}

/// Derivative of the numbers by one parameter: by differences, of which the numbers' curvature asks no care.
template <class Move>
Numbers derivative(const GrooveFit& fit, const GrooveRoot& root, Move&& move) {
    constexpr double kStep = 1e-4;  // mm
    GrooveFit above = fit, below = fit;
    move(above, kStep);
    move(below, -kStep);
    return (values_of(above, root) - values_of(below, root)) / (2 * kStep);
}

struct FaceDerivative {
    const GrooveFace& face;
    Eigen::Matrix<double, GrooveNumbers::kCount, 3> by;
};

}  // namespace

Measured GrooveNumbers::number(int i, double registration) const {
    return {value[i], std::sqrt(variance[i] + registration * registration * shift[i])};
}

double GrooveNumbers::sigma(double registration) const {
    return std::hypot(number(kRootA, registration).sigma, number(kRootH, registration).sigma);
}

double bevel_angle(const GrooveFit& fit, std::size_t k, double u) {
    const Vector2d up = normal_at(fit.top[k], meet(fit.bevel[k], fit.top[k])), t = fit.bevel[k].tangent(u);
    const Vector2d out = k == 0 ? Vector2d(-up[1], up[0]) : Vector2d(up[1], -up[0]);
    return std::atan2(t.dot(out), t.dot(up));
}

double crossing_depth(const GrooveFit& fit, std::size_t k) {
    const Vector2d corner = meet(fit.bevel[k], fit.top[k]);
    return normal_at(fit.top[k], corner).dot(corner - meet(fit.bevel[0], fit.bevel[1]));
}

std::optional<GrooveNumbers> numbers_of(const GrooveFit& fit, const GrooveRoot& root) {
    GrooveNumbers numbers;
    numbers.value = values_of(fit, root);
    if (!numbers.value.allFinite()) {
        return std::nullopt;
    }
    std::vector<std::array<Numbers, 2>> by_view;  // of each view's shift along a and h
    const auto view_at = [&](std::size_t v) -> std::array<Numbers, 2>& {
        if (v >= by_view.size()) {
            by_view.resize(v + 1, {Numbers::Zero(), Numbers::Zero()});
        }
        return by_view[v];
    };
    for (const auto part : {&GrooveFit::top, &GrooveFit::bevel}) {
        for (std::size_t k = 0; k < 2; ++k) {
            const GrooveFace& face = (fit.*part)[k];
            Eigen::Matrix<double, GrooveNumbers::kCount, 3> J;
            for (int i = 0; i < 3; ++i) {
                J.col(i) = derivative(fit, root, [&](GrooveFit& f, double step) { (f.*part)[k].c[i] += step; });
            }
            numbers.variance += (J * face.covariance * J.transpose()).diagonal();
            for (std::size_t v = 0; v < face.shift.size(); ++v) {
                const Numbers moved = J * face.shift[v];
                view_at(v)[0] += face.n[0] * moved;
                view_at(v)[1] += face.n[1] * moved;
            }
        }
    }
    for (std::size_t k = 0; k < 2; ++k) {
        const BevelDepth& lower = fit.lower[k];
        const Numbers J = derivative(fit, root, [&](GrooveFit& f, double step) { f.lower[k].depth += step; });
        numbers.variance += lower.sigma * lower.sigma * J.cwiseAbs2();
        // Points of a bevel's end that move along it carry the end with them, and not the top.
        for (std::size_t v = 0; v < lower.share.size(); ++v) {
            view_at(v)[0] -= fit.bevel[k].d[0] * lower.share[v] * J * fit.bevel[k].d.dot(fit.top[k].n);
            view_at(v)[1] -= fit.bevel[k].d[1] * lower.share[v] * J * fit.bevel[k].d.dot(fit.top[k].n);
        }
    }
    for (const auto& view : by_view) {
        numbers.shift += view[0].cwiseAbs2() + view[1].cwiseAbs2();
    }
    if (root.closed) {
        // How sure it is that there is no gap is what the ends tell of one.
        GrooveRoot open = root;
        open.closed = false;
        const auto of_ends = numbers_of(fit, open);
        if (of_ends) {
            numbers.variance[kGap] = of_ends->variance[kGap];
            numbers.shift[kGap] = of_ends->shift[kGap];
        }
    }
    const Ends e = ends_of(fit, root);
    for (std::size_t k = 0; k < 2; ++k) {
        numbers.normal[k] = normal_at(fit.bevel[k], e.end[k]);
    }
    return numbers;
}

GrooveStation station_of(const GrooveNumbers& numbers, double registration) {
    GrooveStation s;
    s.gap_mm = numbers.number(kGap, registration);
    s.mismatch_mm = numbers.number(kMismatch, registration);
    s.bevel1_rad = numbers.number(kBevel1, registration);
    s.bevel2_rad = numbers.number(kBevel2, registration);
    s.included_angle_rad = numbers.number(kIncluded, registration);
    s.depth_mm = numbers.number(kDepth, registration);
    s.area_mm2 = numbers.number(kArea, registration);
    return s;
}

}  // namespace seampath
