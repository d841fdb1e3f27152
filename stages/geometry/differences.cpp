#include "stages/geometry/differences.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

/// The step that an unequal one is told apart from: not the mean, which it moves.
double median_step(std::span<const double> x) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < x.size(); ++i) {
        steps.push_back(x[i] - x[i - 1]);
    }
    const auto middle = steps.begin() + std::ssize(steps) / 2;
    std::nth_element(steps.begin(), middle, steps.end());
    return *middle;
}

void check_steps(std::span<const double> x) {
    const double step = median_step(x);
    const double rounding = 4e-16 * std::max(std::abs(x[0]), std::abs(x.back()));
    std::size_t worst = 1;
    const auto off = [&](std::size_t i) { return std::abs(x[i] - x[i - 1] - step); };
    for (std::size_t i = 2; i < x.size(); ++i) {
        worst = off(i) > off(worst) ? i : worst;
    }
    if (off(worst) > 1e-9 * step + 2 * rounding) {
        throw InputError("interpolate: the step from row " + std::to_string(worst) + " to row " +
                         std::to_string(worst + 1) + " is " + shortest(x[worst] - x[worst - 1]) +
                         " where the median step is " + shortest(step) +
                         "; finite differences need equal steps; use newton-divided, lagrange or a spline");
    }
}

// The formulas as sums of (factor of U) * (difference or mean of two), term by term.

double newton_forward(const DifferenceTable& t, const Placement& at) {  // (9)
    double sum = 0, factor = 1;
    for (std::size_t k = 0; k <= at.degree; ++k) {
        sum += factor * t(k, at.origin);
        factor *= (at.u - static_cast<double>(k)) / static_cast<double>(k + 1);
    }
    return sum;
}

double newton_backward(const DifferenceTable& t, const Placement& at) {  // (11)
    double sum = 0, factor = 1;
    for (std::size_t k = 0; k <= at.degree; ++k) {
        sum += factor * t(k, at.origin - k);
        factor *= (at.u + static_cast<double>(k)) / static_cast<double>(k + 1);
    }
    return sum;
}

double stirling(const DifferenceTable& t, const Placement& at) {  // (12)
    double sum = t(0, at.origin), factor = 1;                     // factor: (U^2 - 1) ... (U^2 - (k-1)^2) / (2k-2)!
    for (std::size_t k = 1; 2 * k <= at.degree; ++k) {
        const double n = static_cast<double>(2 * k);
        const double mean = (t(2 * k - 1, at.origin - k) + t(2 * k - 1, at.origin - k + 1)) / 2;
        sum += factor * at.u / (n - 1) * mean + factor * at.u * at.u / ((n - 1) * n) * t(2 * k, at.origin - k);
        factor *= (at.u * at.u - static_cast<double>(k * k)) / ((n - 1) * n);
    }
    return sum;
}

double bessel(const DifferenceTable& t, const Placement& at) {  // (13)
    const double u = at.u;
    double sum = t(0, at.origin) + u * t(1, at.origin);
    double factor = u * (u - 1) / 2;  // U (U^2 - 1) ... (U^2 - (k-1)^2) (U - k) / (2k)!
    for (std::size_t k = 1; 2 * k + 1 <= at.degree; ++k) {
        const double n = static_cast<double>(2 * k), j = static_cast<double>(k);
        const double mean = (t(2 * k, at.origin - k) + t(2 * k, at.origin - k + 1)) / 2;
        sum += factor * mean + factor * (u - 0.5) / (n + 1) * t(2 * k + 1, at.origin - k);
        factor *= (u + j) * (u - j - 1) / ((n + 1) * (n + 2));
    }
    return sum;
}

/// The first of the nodes that the polynomial passes through.
std::size_t first_node(const Placement& at) {
    switch (at.formula) {
        case Formula::newton_forward:
            return at.origin;
        case Formula::newton_backward:
            return at.origin - at.degree;
        default:
            return at.origin - at.degree / 2;
    }
}

}  // namespace

DifferenceTable::DifferenceTable(std::span<const double> x, std::span<const double> y, std::size_t max_order)
    : x_(x.begin(), x.end()) {
    ensure(x.size() >= 2 && x.size() == y.size(), "two values at least, one for each abscissa");
    step_ = (x.back() - x.front()) / static_cast<double>(x.size() - 1);
    check_steps(x);
    column_.emplace_back(y.begin(), y.end());
    while (column_.size() <= std::min(max_order, x.size() - 1)) {
        const auto& last = column_.back();
        std::vector<double> next(last.size() - 1);
        for (std::size_t i = 0; i < next.size(); ++i) {
            next[i] = last[i + 1] - last[i];
        }
        column_.push_back(std::move(next));
    }
}

std::size_t DifferenceTable::interval(double x) const {
    const auto above = std::upper_bound(x_.begin() + 1, x_.end() - 1, x);
    return static_cast<std::size_t>(above - x_.begin()) - 1;
}

Placement place(const DifferenceTable& table, Formula formula, double x, std::size_t degree) {
    const std::size_t n = table.nodes() - 1, i = table.interval(x);
    std::size_t m = std::min({degree, n, table.max_order()});
    std::size_t origin = 0;
    if (formula == Formula::stirling && m < 2) {
        formula = Formula::newton_forward;
    }
    switch (formula) {
        case Formula::newton_forward:
            origin = std::min(i, n - m);
            break;
        case Formula::newton_backward:
            origin = std::max(i + 1, m);
            break;
        case Formula::stirling:
            m -= m % 2;
            origin = std::clamp(x - table.x(i) <= table.step() / 2 ? i : i + 1, m / 2, n - m / 2);
            break;
        case Formula::bessel:
            m -= 1 - m % 2;
            origin = std::clamp(i, m / 2, n - 1 - m / 2);
            break;
    }
    return {formula, origin, (x - table.x(origin)) / table.step(), m};
}

Placement choose(const DifferenceTable& table, double x, std::size_t degree) {
    const std::size_t n = table.nodes() - 1, i = table.interval(x);
    const double u = (x - table.x(i)) / table.step();
    const bool between = u >= 0.25 && u <= 0.75;
    const Placement central = place(table, between ? Formula::bessel : Formula::stirling, x, degree);
    const std::size_t wanted = between || u < 0.5 ? i : i + 1;
    if (central.origin == wanted && central.degree >= 2) {
        return central;
    }
    return place(table, 2 * i + 1 < n ? Formula::newton_forward : Formula::newton_backward, x, degree);
}

double value(const DifferenceTable& table, const Placement& at) {
    constexpr std::array kFormulas{newton_forward, newton_backward, stirling, bessel};
    return kFormulas[static_cast<std::size_t>(at.formula)](table, at);
}

double error_factor(const Placement& at) {
    // All four are the product of x's distances from the nodes in steps, over (n+1)!
    const double before = static_cast<double>(at.origin - first_node(at));
    double factor = 1;
    for (std::size_t k = 0; k <= at.degree; ++k) {
        factor *= (at.u + before - static_cast<double>(k)) / static_cast<double>(k + 1);
    }
    return factor;
}

std::optional<double> estimated_error(const DifferenceTable& table, const Placement& at) {
    const std::size_t order = at.degree + 1;
    if (order > table.max_order()) {
        return std::nullopt;
    }
    const std::size_t first = first_node(at), last = table.nodes() - 1 - order;
    double next = 0;
    for (std::size_t i = first == 0 ? 0 : first - 1; i <= std::min(first, last); ++i) {
        next = std::max(next, std::abs(table(order, i)));
    }
    return std::abs(error_factor(at)) * next;
}

}  // namespace seampath
