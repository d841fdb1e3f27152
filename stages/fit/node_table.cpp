#include "stages/fit/node_table.hpp"

#include <cmath>
#include <string>

#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;
using Values = std::vector<double>;

/// Marin's parameters of the nodes, from 0 to `length`. A ring is laid three times round and the middle one taken:
/// there it has no ends.
Values marin(const std::vector<Vector3d>& p, Objective objective, bool closed, double length) {
    const std::size_t n = p.size();
    std::vector<Eigen::VectorXd> points;
    for (std::size_t k = 0; k < (closed ? 3 * n + 1 : n); ++k) {
        points.emplace_back(p[k % n]);
    }
    ParametrizeOptions options;
    options.objective = objective;
    const Values t = parametrize(points, options).t;
    const std::size_t first = closed ? n : 0, last = closed ? 2 * n : n - 1;
    Values result;
    for (std::size_t k = first; k <= last; ++k) {
        result.push_back((t[k] - t[first]) / (t[last] - t[first]) * length);
    }
    return result;
}

Values coordinate(const std::vector<Vector3d>& p, Eigen::Index axis) {
    Values values;
    for (const Vector3d& point : p) {
        values.push_back(point[axis]);
    }
    return values;
}

Vector3d value(const Lines& lines, double t) {
    return {lines[0].cubic->value(t), lines[1].cubic->value(t), lines[2].cubic->value(t)};
}

/// Throws where t doesn't ascend from node to node.
void check_ascending(const NodeTable& table, const FitOptions& o) {
    const auto k = first_not_ascending(table.t);
    if (!k) {
        return;
    }
    const std::string where = "node " + std::to_string(*k) + " to node " + std::to_string(*k + 1) + ", " +
                              fixed(table.s[*k], 2) + " mm along the seam";
    if (o.axis == FitAxis::length) {
        throw InputError("fit: from " + where +
                         ", the seam does not get on; nodes in different places were needed; "
                         "check the seam there");
    }
    const std::string axis(kFitAxisNames[static_cast<std::size_t>(o.axis)]);
    throw InputError("fit: fit.axis " + axis + ": the seam is no function of " + axis + ": from " + where +
                     ", it turns back by " + fixed(table.t[*k] - table.t[*k + 1], 3) +
                     " mm; set fit.axis to length or to another axis");
}

/// The parameter along an axis, so that it ascends from the seam's first point to its last.
double along(const Vector3d& p, const FitOptions& o, const Vector3d& first, const Vector3d& last) {
    const auto axis = static_cast<Eigen::Index>(o.axis) - 1;
    return last[axis] < first[axis] ? -p[axis] : p[axis];
}

}  // namespace

Values lengths(const std::vector<Vector3d>& p, bool closed) {
    Values s{0};
    for (std::size_t i = 1; i < p.size() + (closed ? 1 : 0); ++i) {
        s.push_back(s.back() + (p[i % p.size()] - p[i - 1]).norm());
    }
    return s;
}

NodeTable carried_on(const NodeTable& ring, std::ptrdiff_t before, std::ptrdiff_t behind) {
    const auto n = std::ssize(ring.t);
    NodeTable table;
    for (std::ptrdiff_t k = -before; k < n + behind; ++k) {
        const std::ptrdiff_t turns = k >= 0 ? k / n : -((n - 1 - k) / n);
        const auto at = static_cast<std::size_t>(k - turns * n);
        table.t.push_back(ring.t[at] + static_cast<double>(turns) * ring.period);
        table.p.push_back(ring.p[at]);
    }
    return table;
}

Lines interpolated(const NodeTable& table, Method method, const InterpolateOptions& options) {
    return {interpolate(method, table.t, coordinate(table.p, 0), options),
            interpolate(method, table.t, coordinate(table.p, 1), options),
            interpolate(method, table.t, coordinate(table.p, 2), options)};
}

NodeTable placed_nodes(const CurvePoints& points, const Values& s, const Nodes& nodes, bool closed,
                       const FitOptions& o) {
    NodeTable table;
    for (const std::size_t i : nodes.index) {
        table.p.push_back(points.p[i]);
        table.s.push_back(s[i]);
    }
    table.t = table.s;
    table.period = closed ? s.back() : 0;
    if (nodes.line) {
        table.p = nodes.line->p;
        table.t = nodes.line->station_mm;
        table.period = closed ? nodes.line->length_mm : 0;
    }
    if (o.axis != FitAxis::length) {
        for (std::size_t k = 0; k < table.t.size(); ++k) {
            table.t[k] = along(table.p[k], o, points.p.front(), points.p.back());
        }
    }
    check_ascending(table, o);
    if (o.model == FitModel::parametric) {
        table.t = marin(table.p, o.parametrization, closed, s.back());
        table.t.resize(table.p.size());
    }
    return table;
}

NodeTable equal_nodes(const CurvePoints& points, const Values& s, const NodeTable& like, bool closed,
                      const FitOptions& o) {
    NodeTable all{s, points.p, s, closed ? s.back() : 0};
    all.t.resize(points.p.size());
    check_ascending(all, {});
    const Lines akima = interpolated(closed ? carried_on(all, kBeyond, kBeyond) : all, Method::akima, {});
    const std::size_t n = like.t.size(), steps = closed ? n : n - 1;
    const double first = closed ? 0 : like.t.front(), range = closed ? s.back() : like.t.back() - first;
    NodeTable table;
    table.period = like.period;
    for (std::size_t k = 0; k < n; ++k) {
        table.t.push_back(first + range * static_cast<double>(k) / static_cast<double>(steps));
        double low = 0, high = s.back();  // by bisection: the line reaches its last value after its first
        const auto reached = [&](double at) {
            return o.axis == FitAxis::length ? at : along(value(akima, at), o, points.p.front(), points.p.back());
        };
        for (double middle = high / 2; low < middle && middle < high; middle = (low + high) / 2) {
            (reached(middle) < table.t[k] ? low : high) = middle;
        }
        table.s.push_back(k == 0 ? 0 : high);
        table.p.push_back(value(akima, table.s[k]));
        if (o.axis != FitAxis::length) {
            const auto axis = static_cast<Eigen::Index>(o.axis) - 1;
            table.p[k][axis] = points.p.back()[axis] < points.p.front()[axis] ? -table.t[k] : table.t[k];
        }
    }
    return table;
}

}  // namespace seampath
