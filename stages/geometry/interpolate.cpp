#include "stages/geometry/interpolate.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "stages/error.hpp"
#include "stages/geometry/polynomial.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Eigen::Vector2d;
using Values = std::vector<double>;

constexpr double kLargest = 1e100;  // so that no square or cube overflows

struct Input {
    std::span<const double> x, y;
    const InterpolateOptions& options;
};

void check(const Input& in) {
    if (in.x.size() < 2 || in.x.size() != in.y.size()) {
        throw InputError("interpolate: " + std::to_string(in.x.size()) + " rows; at least 2 were needed; add rows");
    }
    if (in.options.degree < 1 || in.options.degree > kMaxDegree) {
        throw InputError("interpolate: degree " + std::to_string(in.options.degree) + "; 1 to " +
                         std::to_string(kMaxDegree) + " was needed");
    }
    for (const double slope : in.options.end_slopes.value_or(std::array<double, 2>{})) {
        if (!(std::abs(slope) <= kLargest)) {
            throw InputError("interpolate: an end slope is " + shortest(slope) +
                             "; finite numbers of at most 1e100 were needed");
        }
    }
    for (std::size_t i = 0; i < in.x.size(); ++i) {
        if (!(std::abs(in.x[i]) <= kLargest && std::abs(in.y[i]) <= kLargest)) {
            throw InputError("interpolate: row " + std::to_string(i + 1) +
                             " is not finite or beyond 1e100; correct it or take another unit");
        }
    }
    if (const auto i = first_not_ascending(in.x)) {
        throw InputError("interpolate: row " + std::to_string(*i + 2) + " has x = " + shortest(in.x[*i + 1]) +
                         " after x = " + shortest(in.x[*i]) + "; x must ascend from row to row; sort the table");
    }
}

void check_inside(double x, double first, double last) {
    if (!(x >= first && x <= last)) {
        throw InputError("interpolate: x = " + shortest(x) + " lies outside the table, which goes from " +
                         shortest(first) + " to " + shortest(last) + "; remove it or extend the table");
    }
}

/// A function of x as an interpolant.
Interpolant graph(Values x, const std::function<Evaluation(double)>& f) {
    Interpolant line;
    const double first = x.front(), last = x.back();
    line.evaluate = [f, first, last](double at) {
        check_inside(at, first, last);
        return f(at);
    };
    line.at = [f](double t) { return Vector2d(t, f(t).y); };
    line.t = std::move(x);
    return line;
}

/// First and last node of each part, within which polynomials stay.
std::vector<std::pair<std::size_t, std::size_t>> parts(const Input& in) {
    std::vector<std::pair<std::size_t, std::size_t>> all;
    std::size_t first = 0;
    if (in.options.split_at_inflections) {
        for (const Inflection& inflection : inflections(in.x, in.y)) {
            all.emplace_back(first, inflection.node);
            first = inflection.node;
        }
    }
    all.emplace_back(first, in.x.size() - 1);
    return all;
}

/// The interpolant that takes for each x the function of its part.
template <typename Part>
Interpolant graph_of_parts(const Input& in, std::vector<Part> part, Evaluation (*evaluate)(const Part&, double)) {
    Values starts;
    for (const auto& [first, last] : parts(in)) {
        starts.push_back(in.x[first]);
    }
    const auto shared = std::make_shared<const std::vector<Part>>(std::move(part));
    return graph({in.x.begin(), in.x.end()}, [shared, starts, evaluate](double x) {
        const auto above = std::upper_bound(starts.begin() + 1, starts.end(), x);
        return evaluate((*shared)[static_cast<std::size_t>(above - starts.begin()) - 1], x);
    });
}

/// Finite differences of one part and how they are used.
struct Differences {
    DifferenceTable table;
    std::size_t degree;
    std::optional<Formula> formula;  ///< or the recommended one
};

Evaluation evaluate_differences(const Differences& part, double x) {
    const Placement at =
        part.formula ? place(part.table, *part.formula, x, part.degree) : choose(part.table, x, part.degree);
    return {value(part.table, at), at, estimated_error(part.table, at)};
}

Interpolant by_differences(const Input& in, std::optional<Formula> formula) {
    std::vector<Differences> all;
    const DifferenceTable whole(in.x, in.y, 1);  // equal steps are asked of the whole table
    for (const auto& [first, last] : parts(in)) {
        const std::size_t count = last - first + 1;
        all.push_back({DifferenceTable(in.x.subspan(first, count), in.y.subspan(first, count), in.options.degree + 1),
                       in.options.degree, formula});
    }
    return graph_of_parts(in, std::move(all), evaluate_differences);
}

/// Nodes of one part and how many are taken at once.
struct Nodes {
    Values x, y;
    std::size_t degree;
    bool lagrange;
};

Evaluation evaluate_nodes(const Nodes& part, double x) {
    const std::size_t n = part.x.size() - 1, m = std::min(part.degree, n);
    const auto above = std::upper_bound(part.x.begin() + 1, part.x.end() - 1, x);
    std::size_t i = static_cast<std::size_t>(above - part.x.begin()) - 1;
    if (m % 2 == 0 && x - part.x[i] > part.x[i + 1] - x) {
        ++i;  // an odd number of nodes lies around the nearest one
    }
    const std::size_t before = m % 2 == 0 ? m / 2 : (m - 1) / 2;
    const std::size_t first = std::min(i - std::min(i, before), n - m);
    const auto xs = std::span(part.x).subspan(first, m + 1), ys = std::span(part.y).subspan(first, m + 1);
    const double y = part.lagrange ? lagrange_value(xs, ys, x) : newton_value(xs, divided_differences(xs, ys), x);
    return {y, std::nullopt, std::nullopt};
}

Interpolant by_nodes(const Input& in, bool lagrange) {
    std::vector<Nodes> all;
    for (const auto& [first, last] : parts(in)) {
        const auto begin = static_cast<std::ptrdiff_t>(first), end = static_cast<std::ptrdiff_t>(last) + 1;
        all.push_back({{in.x.begin() + begin, in.x.begin() + end},
                       {in.y.begin() + begin, in.y.begin() + end},
                       in.options.degree,
                       lagrange});
    }
    return graph_of_parts(in, std::move(all), evaluate_nodes);
}

Interpolant by_spline(PiecewiseCubic spline) {
    Interpolant line = graph(spline.x, [spline](double at) {
        return Evaluation{spline.value(at), std::nullopt, std::nullopt};
    });
    line.cubic = std::move(spline);
    return line;
}

Interpolant natural(const Input& in) {
    return by_spline(natural_spline(in.x, in.y));
}

/// Slope, at the end that h0 lies at, of the parabola over two chords; h lengths, m slopes.
double end_slope(double h0, double h1, double m0, double m1) {
    return m0 + (m0 - m1) * h0 / (h0 + h1);
}

Interpolant clamped(const Input& in) {
    if (in.options.end_slopes) {
        return by_spline(clamped_spline(in.x, in.y, (*in.options.end_slopes)[0], (*in.options.end_slopes)[1]));
    }
    const std::size_t n = in.x.size() - 1;
    if (n == 1) {
        return natural(in);
    }
    const PiecewiseCubic chord = linear_spline(in.x, in.y);
    const auto h = [&](std::size_t i) { return in.x[i + 1] - in.x[i]; };
    return by_spline(clamped_spline(in.x, in.y, end_slope(h(0), h(1), chord.b[0], chord.b[1]),
                                    end_slope(h(n - 1), h(n - 2), chord.b[n - 1], chord.b[n - 2])));
}

Interpolant periodic(const Input& in) {
    if (in.x.size() < 4 || in.y.front() != in.y.back()) {
        throw InputError("interpolate: periodic: the table has " + std::to_string(in.x.size()) +
                         " rows and goes from y = " + shortest(in.y.front()) + " to y = " + shortest(in.y.back()) +
                         "; at least 4 rows and equal ends were needed; use another spline");
    }
    return by_spline(periodic_spline(in.x, in.y));
}

/// The parameter within interval i of x(t) at which x is reached, by bisection: x(t) passes the nodes on both sides.
double parameter_at(const PiecewiseCubic& x_of_t, std::size_t i, double x) {
    double low = x_of_t.x[i], high = x_of_t.x[i + 1];
    for (double middle = (low + high) / 2; low < middle && middle < high; middle = (low + high) / 2) {
        (x_of_t.value(middle) < x ? low : high) = middle;
    }
    return high;
}

Interpolant parametric(const Input& in) {
    std::vector<Eigen::VectorXd> points;
    for (std::size_t i = 0; i < in.x.size(); ++i) {
        points.emplace_back(Vector2d(in.x[i], in.y[i]));
    }
    ParametrizeOptions options;
    options.objective = in.options.parametrization;
    const Values nodes(in.x.begin(), in.x.end());
    Interpolant line;
    line.t = parametrize(points, options).t;
    const PiecewiseCubic x = natural_spline(line.t, in.x), y = natural_spline(line.t, in.y);
    line.at = [x, y](double t) { return Vector2d(x.value(t), y.value(t)); };
    line.evaluate = [x, y, nodes](double at) {
        check_inside(at, nodes.front(), nodes.back());
        const auto above = std::upper_bound(nodes.begin() + 1, nodes.end() - 1, at);
        const double t = parameter_at(x, static_cast<std::size_t>(above - nodes.begin()) - 1, at);
        return Evaluation{y.value(t), std::nullopt, std::nullopt};
    };
    return line;
}

/// In the order of Method.
constexpr std::array<Interpolant (*)(const Input&), kMethodNames.size()> kMethods{
    [](const Input& in) { return by_differences(in, Formula::newton_forward); },
    [](const Input& in) { return by_differences(in, Formula::newton_backward); },
    [](const Input& in) { return by_differences(in, Formula::stirling); },
    [](const Input& in) { return by_differences(in, Formula::bessel); },
    [](const Input& in) { return by_differences(in, std::nullopt); },
    [](const Input& in) { return by_nodes(in, true); },
    [](const Input& in) { return by_nodes(in, false); },
    natural,
    clamped,
    [](const Input& in) { return by_spline(not_a_knot_spline(in.x, in.y)); },
    periodic,
    [](const Input& in) { return by_spline(akima_spline(in.x, in.y)); },
    [](const Input& in) { return by_spline(pchip_spline(in.x, in.y)); },
    [](const Input& in) { return by_spline(linear_spline(in.x, in.y)); },
    parametric};

}  // namespace

std::optional<std::size_t> first_not_ascending(std::span<const double> x) {
    const auto found = std::adjacent_find(x.begin(), x.end(), std::greater_equal<>());
    return found == x.end() ? std::nullopt : std::optional(static_cast<std::size_t>(found - x.begin()));
}

Interpolant interpolate(Method method, std::span<const double> x, std::span<const double> y,
                        const InterpolateOptions& options) {
    const Input in{x, y, options};
    check(in);
    Interpolant line = kMethods[static_cast<std::size_t>(method)](in);
    line.method = method;
    return line;
}

std::vector<Inflection> inflections(std::span<const double> x, std::span<const double> y) {
    std::vector<Inflection> found;
    std::size_t last = 0;  // inner node with the last sign
    double last_bend = 0;
    for (std::size_t i = 1; i + 1 < x.size(); ++i) {
        const double h0 = x[i] - x[i - 1], h1 = x[i + 1] - x[i];
        const double turn = (y[i + 1] - y[i]) / h1 - (y[i] - y[i - 1]) / h0;
        const double rounding = 1e-14 * (std::abs(y[i - 1]) + std::abs(y[i]) + std::abs(y[i + 1])) / std::min(h0, h1);
        if (std::abs(turn) <= rounding) {
            continue;
        }
        const double bend = turn / (h0 + h1);
        if (bend * last_bend < 0) {
            // Where nodes without bend lie between, the line is straight, and its middle is as good as any.
            const double share = i - last > 1 ? 0.5 : std::abs(last_bend) / (std::abs(last_bend) + std::abs(bend));
            const double zero = x[last] + share * (x[i] - x[last]);
            std::size_t node = last;
            while (std::abs(x[node + 1] - zero) < std::abs(x[node] - zero)) {
                ++node;
            }
            if (found.empty() || node > found.back().node) {
                found.push_back({zero, node});
            }
        }
        last = i;
        last_bend = bend;
    }
    return found;
}

}  // namespace seampath
