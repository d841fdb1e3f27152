#include "stages/geometry/piecewise_cubic.hpp"

#include <algorithm>
#include <cmath>

#include "stages/error.hpp"
#include "stages/geometry/tridiagonal.hpp"

namespace seampath {
namespace {

using Ordinates = std::vector<double>;

/// Lengths h and slopes m of the chords; h[i] and m[i] belong to the interval after node i.
struct Chords {
    Ordinates h;
    Ordinates m;

    Chords(std::span<const double> x, std::span<const double> y) {
        ensure(x.size() >= 2 && x.size() == y.size(), "two nodes at least, a value for each");
        for (std::size_t i = 0; i + 1 < x.size(); ++i) {
            h.push_back(x[i + 1] - x[i]);
            m.push_back((y[i + 1] - y[i]) / h[i]);
        }
    }
    std::size_t intervals() const { return h.size(); }
};

/// b and d from c by (34), (32), with c_{n+1} of (37) as its last value.
PiecewiseCubic from_second(std::span<const double> x, std::span<const double> y, const Chords& chord,
                           const Ordinates& c) {
    const std::size_t n = chord.intervals();
    PiecewiseCubic s{
        {x.begin(), x.end()}, {y.begin(), y.end() - 1}, Ordinates(n), {c.begin(), c.end() - 1}, Ordinates(n)};
    for (std::size_t i = 0; i < n; ++i) {
        s.b[i] = chord.m[i] - chord.h[i] * (c[i + 1] + 2 * c[i]) / 3;
        s.d[i] = (c[i + 1] - c[i]) / (3 * chord.h[i]);
    }
    return s;
}

/// Hermite's cubics: slopes at the nodes.
PiecewiseCubic from_slopes(std::span<const double> x, std::span<const double> y, const Chords& chord,
                           const Ordinates& slope) {
    const std::size_t n = chord.intervals();
    PiecewiseCubic s{
        {x.begin(), x.end()}, {y.begin(), y.end() - 1}, {slope.begin(), slope.end() - 1}, Ordinates(n), {}};
    for (std::size_t i = 0; i < n; ++i) {
        const double h = chord.h[i], m = chord.m[i];
        s.c[i] = (3 * m - 2 * slope[i] - slope[i + 1]) / h;
        s.d.push_back((slope[i] + slope[i + 1] - 2 * m) / (h * h));
    }
    return s;
}

/// The equations (36) for the c of the inner nodes; those of the ends are to be filled in, c = 0 until then.
struct Equations {
    Ordinates lower, diagonal, upper, right;

    explicit Equations(const Chords& chord)
        : lower(chord.intervals() + 1, 0), diagonal(lower.size(), 1), upper(lower.size(), 0), right(lower.size(), 0) {
        for (std::size_t i = 1; i < chord.intervals(); ++i) {
            lower[i] = chord.h[i - 1];
            diagonal[i] = 2 * (chord.h[i - 1] + chord.h[i]);
            upper[i] = chord.h[i];
            right[i] = 3 * (chord.m[i] - chord.m[i - 1]);
        }
    }

    Ordinates solve() const {
        Ordinates c = right;
        Tridiagonal(lower, diagonal, upper).solve(c);
        return c;
    }
};

std::size_t interval(const PiecewiseCubic& s, double at) {
    const auto above = std::upper_bound(s.x.begin() + 1, s.x.end() - 1, at);
    return static_cast<std::size_t>(above - s.x.begin()) - 1;
}

/// PCHIP's slope at an end from the two chords next to it.
double pchip_end(double h0, double h1, double m0, double m1) {
    const double slope = ((2 * h0 + h1) * m0 - h0 * m1) / (h0 + h1);
    if (slope * m0 <= 0) {
        return 0;
    }
    return m0 * m1 <= 0 && std::abs(slope) > 3 * std::abs(m0) ? 3 * m0 : slope;
}

}  // namespace

double PiecewiseCubic::value(double at) const {
    const std::size_t i = interval(*this, at);
    const double u = at - x[i];
    return a[i] + u * (b[i] + u * (c[i] + u * d[i]));
}

double PiecewiseCubic::slope(double at) const {
    const std::size_t i = interval(*this, at);
    const double u = at - x[i];
    return b[i] + u * (2 * c[i] + 3 * u * d[i]);
}

double PiecewiseCubic::second(double at) const {
    const std::size_t i = interval(*this, at);
    return 2 * c[i] + 6 * d[i] * (at - x[i]);
}

PiecewiseCubic natural_spline(std::span<const double> x, std::span<const double> y) {
    const Chords chord(x, y);
    return from_second(x, y, chord, Equations(chord).solve());
}

PiecewiseCubic clamped_spline(std::span<const double> x, std::span<const double> y, double first_slope,
                              double last_slope) {
    const Chords chord(x, y);
    const std::size_t n = chord.intervals();
    Equations equations(chord);
    equations.diagonal[0] = 2 * chord.h[0];
    equations.upper[0] = chord.h[0];
    equations.right[0] = 3 * (chord.m[0] - first_slope);
    equations.lower[n] = chord.h[n - 1];
    equations.diagonal[n] = 2 * chord.h[n - 1];
    equations.right[n] = 3 * (last_slope - chord.m[n - 1]);
    return from_second(x, y, chord, equations.solve());
}

PiecewiseCubic not_a_knot_spline(std::span<const double> x, std::span<const double> y) {
    const Chords chord(x, y);
    const std::size_t n = chord.intervals();
    const auto& h = chord.h;
    if (n < 3) {
        const double c = n == 1 ? 0 : (chord.m[1] - chord.m[0]) / (h[0] + h[1]);
        return from_second(x, y, chord, Ordinates(n + 1, c));
    }
    // d_1 = d_2 and d_{n-1} = d_n give c of the ends by those of their two neighbours.
    Equations equations(chord);
    const double first = h[0] / h[1], last = h[n - 1] / h[n - 2];
    equations.diagonal[1] += h[0] * (1 + first);
    equations.upper[1] -= h[0] * first;
    equations.lower[1] = 0;
    equations.diagonal[n - 1] += h[n - 1] * (1 + last);
    equations.lower[n - 1] -= h[n - 1] * last;
    equations.upper[n - 1] = 0;
    Ordinates c = equations.solve();
    c[0] = c[1] * (1 + first) - c[2] * first;
    c[n] = c[n - 1] * (1 + last) - c[n - 2] * last;
    return from_second(x, y, chord, c);
}

PiecewiseCubic periodic_spline(std::span<const double> x, std::span<const double> y) {
    const Chords chord(x, y);
    const std::size_t n = chord.intervals();
    ensure(n >= 3 && y[0] == y[n], "a period of three intervals at least");
    Equations equations(chord);
    equations.lower[0] = chord.h[n - 1];
    equations.diagonal[0] = 2 * (chord.h[n - 1] + chord.h[0]);
    equations.upper[0] = chord.h[0];
    equations.right[0] = 3 * (chord.m[0] - chord.m[n - 1]);
    const auto ring = [n](const Ordinates& v) { return std::span(v).first(n); };
    Ordinates c =
        solve_cyclic(ring(equations.lower), ring(equations.diagonal), ring(equations.upper), ring(equations.right));
    c.push_back(c[0]);
    return from_second(x, y, chord, c);
}

PiecewiseCubic akima_spline(std::span<const double> x, std::span<const double> y) {
    const Chords chord(x, y);
    const std::size_t n = chord.intervals();
    if (n == 1) {
        return linear_spline(x, y);
    }
    // m[i + 2] is the slope of chord i; two more beyond either end, as those of a parabola go on.
    Ordinates m(n + 4);
    std::copy(chord.m.begin(), chord.m.end(), m.begin() + 2);
    m[1] = 2 * m[2] - m[3];
    m[0] = 2 * m[1] - m[2];
    m[n + 2] = 2 * m[n + 1] - m[n];
    m[n + 3] = 2 * m[n + 2] - m[n + 1];
    Ordinates slope(n + 1);
    double most = 0;
    for (std::size_t i = 0; i + 1 < m.size(); ++i) {
        most = std::max(most, std::abs(m[i + 1] - m[i]));
    }
    for (std::size_t i = 0; i <= n; ++i) {
        const double before = std::abs(m[i + 1] - m[i]), after = std::abs(m[i + 3] - m[i + 2]);
        // Akima's 0 / 0: straight on both sides, to rounding.
        const bool undecided = before + after <= 1e-9 * most;
        const double share = undecided ? 0.5 : after / (before + after);
        slope[i] = share * m[i + 1] + (1 - share) * m[i + 2];
    }
    return from_slopes(x, y, chord, slope);
}

PiecewiseCubic pchip_spline(std::span<const double> x, std::span<const double> y) {
    const Chords chord(x, y);
    const std::size_t n = chord.intervals();
    const auto& [h, m] = chord;
    if (n == 1) {
        return linear_spline(x, y);
    }
    Ordinates slope(n + 1, 0);
    for (std::size_t i = 1; i < n; ++i) {
        if (m[i - 1] * m[i] > 0) {
            const double w1 = 2 * h[i] + h[i - 1], w2 = h[i] + 2 * h[i - 1];
            slope[i] = (w1 + w2) / (w1 / m[i - 1] + w2 / m[i]);
        }
    }
    slope[0] = pchip_end(h[0], h[1], m[0], m[1]);
    slope[n] = pchip_end(h[n - 1], h[n - 2], m[n - 1], m[n - 2]);
    return from_slopes(x, y, chord, slope);
}

PiecewiseCubic linear_spline(std::span<const double> x, std::span<const double> y) {
    const Chords chord(x, y);
    const Ordinates zero(chord.intervals(), 0);
    return {{x.begin(), x.end()}, {y.begin(), y.end() - 1}, chord.m, zero, zero};
}

}  // namespace seampath
