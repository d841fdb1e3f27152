#include "stages/geometry/bspline.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "stages/error.hpp"
#include "stages/geometry/gauss_legendre.hpp"

namespace seampath {
namespace {

// Pieces of the arc-length table per knot span: |c'| is no polynomial, short pieces keep the quadrature at rounding
// level.
constexpr int kPiecesPerSpan = 4;

double wrap(double u, double first, double period) {
    if (u >= first && u < first + period) {
        return u;
    }
    const double turns = std::floor((u - first) / period);
    return std::clamp(u - turns * period, first, first + period);
}

// The last of the spans `first` to `last` that begins at u or before. Knots are mostly about as dense everywhere:
// looked for where it then is, and only else by halves.
std::ptrdiff_t span_at(const std::vector<double>& knots, std::ptrdiff_t first, std::ptrdiff_t last, double u) {
    constexpr int kSteps = 6;
    const double share = (u - knots[first]) / (knots[last + 1] - knots[first]);
    std::ptrdiff_t span = std::clamp<std::ptrdiff_t>(
        first + static_cast<std::ptrdiff_t>(share * static_cast<double>(last + 1 - first)), first, last);
    for (int step = 0; step < kSteps; ++step) {
        if (span < last && knots[span + 1] <= u) {
            ++span;
        } else if (span > first && knots[span] > u) {
            --span;
        } else {
            return span;
        }
    }
    const auto begin = knots.begin() + first, end = knots.begin() + last + 1;
    return std::clamp<std::ptrdiff_t>(std::upper_bound(begin, end, u) - knots.begin() - 1, first, last);
}

// Knot j of a ring of n, which may lie some turns on or back.
double knot_of_ring(const std::vector<double>& knots, std::ptrdiff_t n, double period, std::ptrdiff_t j) {
    double turns = 0;
    for (; j < 0; j += n) {
        turns -= 1;
    }
    for (; j >= n; j -= n) {
        turns += 1;
    }
    return knots[j] + turns * period;
}

template <class Weights>
Eigen::Vector3d combine(const CubicBSpline& curve, const CubicBasis& basis, const Weights& weights) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int k = 0; k < 4; ++k) {
        sum += weights[k] * curve.control[basis.control[k]];
    }
    return sum;
}

CubicBasis basis_at(const CubicBSpline& curve, double u) {
    return cubic_basis(curve.knots, curve.control.size(), curve.periodic, u);
}

// Between a and b, which lie in one span: c' is a polynomial of degree 2 there, told by two places.
double speed_integral(const CubicBSpline& curve, double a, double b) {
    const double at = a + 0.25 * (b - a), apart = 0.5 * (b - a);
    const CubicBasis one = basis_at(curve, at), other = basis_at(curve, at + apart);
    const Eigen::Vector3d d1 = combine(curve, one, one.d1), d2 = combine(curve, one, one.d2);
    const Eigen::Vector3d d3 = apart > 0 ? Eigen::Vector3d((combine(curve, other, other.d2) - d2) / apart) : d2;
    return gauss_legendre([&](double u) { return (d1 + (u - at) * (d2 + 0.5 * (u - at) * d3)).norm(); }, a, b);
}

}  // namespace

CubicBasis cubic_basis(const std::vector<double>& knots, std::size_t controls, bool periodic, double u) {
    // The eight knots around u: t[3] <= u <= t[4].
    std::array<double, 8> t;
    CubicBasis basis;
    if (periodic) {
        const auto n = static_cast<std::ptrdiff_t>(controls);
        const double period = knots.back() - knots.front();
        u = wrap(u, knots.front(), period);
        const std::ptrdiff_t span = span_at(knots, 0, n - 1, u);
        const bool inside = span >= 3 && span + 4 < n;
        for (std::ptrdiff_t k = 0; k < 8; ++k) {
            t[k] = inside ? knots[span + k - 3] : knot_of_ring(knots, n, period, span + k - 3);
        }
        for (std::ptrdiff_t k = 0; k < 4; ++k) {
            basis.control[k] = static_cast<std::size_t>(span + k < n ? span + k : (span + k) % n);
        }
    } else {
        u = std::clamp(u, knots[3], knots[controls]);
        const std::ptrdiff_t span = span_at(knots, 3, static_cast<std::ptrdiff_t>(controls) - 1, u);
        for (std::ptrdiff_t k = 0; k < 8; ++k) {
            t[k] = knots[span + k - 3];
        }
        for (std::ptrdiff_t k = 0; k < 4; ++k) {
            basis.control[k] = static_cast<std::size_t>(span - 3 + k);
        }
    }
    // Cox-de Boor, degree by degree: each function of degree d gives shares to two of degree d + 1. All of them are not
    // zero on [t3, t4], so that no difference of knots is. All divisions stand first: none waits for another.
    std::array<std::array<double, 3>, 4> over;  // one over the length of function k of degree d - 1
    for (int d = 1; d <= 3; ++d) {
        for (int k = 0; k < d; ++k) {
            over[d][k] = 1 / (t[4 + k] - t[4 - d + k]);
        }
    }
    std::array<double, 3> slope, bend;  // differences of the functions of degree 2 and 1, each over its knots
    std::array<double, 4> N{1, 0, 0, 0};
    for (int d = 1; d <= 3; ++d) {
        double carried = 0;
        for (int k = 0; k < d; ++k) {
            const double share = N[k] * over[d][k];
            N[k] = carried + (t[4 + k] - u) * share;
            carried = (u - t[4 - d + k]) * share;
            (d == 3 ? slope : bend)[k] = share;
        }
        N[d] = carried;
        if (d == 2) {
            // The functions of degree 2 have the slopes 2 (share_{k-1} - share_k); their own differences follow.
            const std::array<double, 3> d1{-2 * bend[0], 2 * (bend[0] - bend[1]), 2 * bend[1]};
            for (int k = 0; k < 3; ++k) {
                bend[k] = d1[k] * over[3][k];
            }
            basis.d2 = {-3 * bend[0], 3 * (bend[0] - bend[1]), 3 * (bend[1] - bend[2]), 3 * bend[2]};
        }
    }
    basis.value = N;
    basis.d1 = {-3 * slope[0], 3 * (slope[0] - slope[1]), 3 * (slope[1] - slope[2]), 3 * slope[2]};
    return basis;
}

double first_parameter(const CubicBSpline& curve) {
    return curve.periodic ? curve.knots.front() : curve.knots[3];
}
double last_parameter(const CubicBSpline& curve) {
    return curve.periodic ? curve.knots.back() : curve.knots[curve.control.size()];
}

std::vector<CurveKnot> knots_of(const CubicBSpline& curve) {
    std::vector<CurveKnot> knots;
    const double first = first_parameter(curve), last = last_parameter(curve);
    for (const double u : curve.knots) {
        if (!knots.empty() && knots.back().u == u) {
            --knots.back().continuity;
        } else if (curve.periodic ? u < last : u > first && u < last) {
            knots.push_back({u, 2});
        }
    }
    return knots;
}

Eigen::Vector3d position(const CubicBSpline& curve, double u) {
    const CubicBasis basis = basis_at(curve, u);
    return combine(curve, basis, basis.value);
}
Eigen::Vector3d derivative(const CubicBSpline& curve, double u) {
    const CubicBasis basis = basis_at(curve, u);
    return combine(curve, basis, basis.d1);
}
Eigen::Vector3d second_derivative(const CubicBSpline& curve, double u) {
    const CubicBasis basis = basis_at(curve, u);
    return combine(curve, basis, basis.d2);
}
Eigen::Vector3d tangent(const CubicBSpline& curve, double u) {
    return derivative(curve, u).normalized();
}
double curvature(const CubicBSpline& curve, double u) {
    const Eigen::Vector3d d1 = derivative(curve, u);
    return d1.cross(second_derivative(curve, u)).norm() / std::pow(d1.norm(), 3);
}

ArcLength::ArcLength(CubicBSpline curve) : curve_(std::move(curve)) {
    const double first = first_parameter(curve_), last = last_parameter(curve_);
    ensure(last > first, "a curve needs a domain");
    knot_.push_back(first);
    station_.push_back(0);
    double from = first;
    for (const double knot : curve_.knots) {
        const double to = std::min(knot, last);
        if (to <= from) {
            continue;
        }
        for (int piece = 1; piece <= kPiecesPerSpan; ++piece) {
            const double end = piece == kPiecesPerSpan ? to : from + (to - from) * piece / kPiecesPerSpan;
            station_.push_back(station_.back() + speed_integral(curve_, knot_.back(), end));
            knot_.push_back(end);
        }
        from = to;
    }
}

double ArcLength::station(double u) const {
    const auto above = std::upper_bound(knot_.begin(), knot_.end(), u) - knot_.begin();
    const auto i = static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(above - 1, 0, static_cast<std::ptrdiff_t>(knot_.size()) - 2));
    return station_[i] + speed_integral(curve_, knot_[i], std::clamp(u, knot_.front(), knot_.back()));
}

double ArcLength::parameter(double station) const {
    station = curve_.periodic ? wrap(station, 0, length()) : std::clamp(station, 0.0, length());
    const auto above = std::upper_bound(station_.begin(), station_.end(), station) - station_.begin();
    const auto i = static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(above - 1, 0, static_cast<std::ptrdiff_t>(knot_.size()) - 2));
    const double ds = station_[i + 1] - station_[i];
    double u = ds > 0 ? knot_[i] + (knot_[i + 1] - knot_[i]) * (station - station_[i]) / ds : knot_[i];
    for (int iteration = 0; iteration < 8; ++iteration) {
        const double error = station_[i] + speed_integral(curve_, knot_[i], u) - station;
        const double speed = derivative(curve_, u).norm();
        if (speed <= 0 || std::abs(error) < 1e-13 * (1 + station)) {
            break;
        }
        u = std::clamp(u - error / speed, knot_[i], knot_[i + 1]);
    }
    return u;
}

FootPoint foot_point(const CubicBSpline& curve, const Eigen::Vector3d& p, double start) {
    const double first = first_parameter(curve), last = last_parameter(curve);
    double u = start;
    CubicBasis basis = basis_at(curve, u);
    Eigen::Vector3d r = combine(curve, basis, basis.value) - p;
    for (int iteration = 0; iteration < 20; ++iteration) {
        const Eigen::Vector3d d1 = combine(curve, basis, basis.d1);
        const double slope = r.dot(d1);
        double bend = d1.squaredNorm() + r.dot(combine(curve, basis, basis.d2));
        double enough = 1e-7;  // of the range: Newton's next step would be the square of it
        if (bend <= 0.1 * d1.squaredNorm()) {
            bend = d1.squaredNorm();  // near the centre of curvature Newton's step would leave: Gauss-Newton's does not
            enough = 1e-13;
        }
        double step = -slope / bend;
        if (std::abs(step) <= 1e-13 * (last - first)) {
            break;
        }
        bool moved = false;
        for (int halving = 0; halving < 12 && !moved; ++halving, step *= 0.5) {
            double next = u + step;
            if (!curve.periodic) {
                next = std::clamp(next, first, last);
            }
            const CubicBasis trial = basis_at(curve, next);
            const Eigen::Vector3d off = combine(curve, trial, trial.value) - p;
            if (off.squaredNorm() < r.squaredNorm()) {
                moved = std::abs(next - u) > enough * (last - first);
                basis = trial;
                r = off;
                u = next;
                break;
            }
            if (std::abs(next - u) <= 1e-13 * (last - first)) {
                break;
            }
        }
        if (!moved) {
            break;
        }
    }
    return {curve.periodic ? wrap(u, first, last - first) : u, p + r};
}

double nearest_parameter(const CubicBSpline& curve, const Eigen::Vector3d& p, double start) {
    return foot_point(curve, p, start).u;
}

double nearest_parameter(const CubicBSpline& curve, const Eigen::Vector3d& p) {
    const double first = first_parameter(curve), last = last_parameter(curve);
    const int samples = static_cast<int>(8 * curve.control.size()) + 8;
    double best = first, best_distance = (position(curve, first) - p).squaredNorm();
    for (int i = 1; i <= samples; ++i) {
        const double u = first + (last - first) * i / samples;
        const double distance = (position(curve, u) - p).squaredNorm();
        if (distance < best_distance) {
            best_distance = distance;
            best = u;
        }
    }
    return nearest_parameter(curve, p, best);
}

FlankSample flanks_at(const SeamModel& model, double station_mm) {
    const auto& samples = model.flanks;
    ensure(samples.size() >= 2, "a model needs at least two flank samples");
    const double s = model.closed ? wrap(station_mm, 0, model.length_mm) : std::clamp(station_mm, 0.0, model.length_mm);
    auto above = std::upper_bound(samples.begin(), samples.end(), s,
                                  [](double value, const FlankSample& sample) { return value < sample.station_mm; });
    const bool outside = above == samples.begin() || above == samples.end();
    if (outside && !model.closed) {
        return above == samples.begin() ? samples.front() : samples.back();
    }
    const FlankSample& b = above == samples.end() ? samples.front() : *above;
    const FlankSample& a = above == samples.begin() ? samples.back() : *(above - 1);
    double gap = b.station_mm - a.station_mm, along = s - a.station_mm;
    if (outside) {
        gap += model.length_mm;
        along += above == samples.begin() ? model.length_mm : 0;
    }
    const double w = gap > 0 ? along / gap : 0;
    FlankSample result;
    result.station_mm = s;
    result.n1 = ((1 - w) * a.n1 + w * b.n1).normalized();
    result.n2 = ((1 - w) * a.n2 + w * b.n2).normalized();
    result.sigma_mm = (1 - w) * a.sigma_mm + w * b.sigma_mm;
    result.modelled = w < 0.5 ? a.modelled : b.modelled;
    return result;
}

}  // namespace seampath
