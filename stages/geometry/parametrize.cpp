#include "stages/geometry/parametrize.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "stages/error.hpp"
#include "stages/geometry/bending.hpp"
#include "stages/geometry/golden_section.hpp"
#include "stages/geometry/lbfgs.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kLargestCoordinate = 1e100;  // so that no square overflows

void check_factors(const std::vector<double>& factors, const std::string& what, Index dimensions) {
    if (!factors.empty() && static_cast<Index>(factors.size()) != dimensions) {
        throw InputError("parametrize: " + std::to_string(factors.size()) + " " + what + " for points of " +
                         std::to_string(dimensions) + " coordinates; one for each coordinate was needed");
    }
    for (const double factor : factors) {
        if (!(factor > 0) || !std::isfinite(factor)) {
            throw InputError("parametrize: " + what + ": " + shortest(factor) +
                             " is not above 0; finite numbers above 0 were needed");
        }
    }
}

void check(std::span<const VectorXd> points, const ParametrizeOptions& options) {
    if (points.size() < 2 || points[0].size() == 0) {
        throw InputError("parametrize: " + std::to_string(points.size()) +
                         " points; at least 2 of at least one coordinate were needed; add rows");
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points[i].size() != points[0].size() || !(points[i].cwiseAbs().array() <= kLargestCoordinate).all()) {
            throw InputError("parametrize: row " + std::to_string(i + 1) +
                             " is not finite, beyond 1e100, or differs in dimension from the first; correct it");
        }
    }
    if (const auto i = first_repeated(points)) {
        throw InputError("parametrize: rows " + std::to_string(*i + 1) + " and " + std::to_string(*i + 2) +
                         " are the same point; a spline needs points that differ from their neighbours; remove one");
    }
    check_factors(options.weights, "weights", points[0].size());
    check_factors(options.limits, "limits", points[0].size());
}

std::vector<double> or_ones(const std::vector<double>& factors, const std::vector<double>& otherwise, Index n) {
    if (!factors.empty()) {
        return factors;
    }
    return otherwise.empty() ? std::vector<double>(static_cast<std::size_t>(n), 1) : otherwise;
}

VectorXd normalised(const VectorXd& h) {
    return h / h.sum();
}

VectorXd distances(const MatrixXd& z) {
    return (z.bottomRows(z.rows() - 1) - z.topRows(z.rows() - 1)).rowwise().stableNorm();
}

/// h_i = d_i (1 + 3/2 (theta_{i-1} d_{i-1} / (d_{i-1} + d_i) + theta_i d_{i+1} / (d_i + d_{i+1}))), theta the angle by
/// which the polygon turns at a point, at most a right one.
VectorXd foley_spacing(const MatrixXd& z) {
    const VectorXd d = distances(z);
    VectorXd h = d;
    for (Index i = 0; i + 1 < d.size(); ++i) {  // the point between intervals i and i + 1
        const VectorXd before = (z.row(i + 1) - z.row(i)).transpose() / d[i];
        const VectorXd after = (z.row(i + 2) - z.row(i + 1)).transpose() / d[i + 1];
        const double angle = 2 * std::atan2((after - before).norm(), (after + before).norm());
        const double turn = 1.5 * std::min(angle, std::numbers::pi / 2) / (d[i] + d[i + 1]);
        h[i] += d[i] * turn * d[i + 1];
        h[i + 1] += d[i + 1] * turn * d[i];
    }
    return h;
}

using Energy = std::function<double(const VectorXd& h, VectorXd* gradient)>;

/// The energy over its value at the start, as a function of u = log h: h = exp(u) / sum exp(u) keeps the constraints
/// (3) by itself.
Differentiable in_logarithms(const Energy& energy) {
    return [energy](const VectorXd& u, VectorXd& gradient) {
        const VectorXd h = normalised((u.array() - u.maxCoeff()).exp());
        const double value = energy(h, &gradient);
        gradient = h.cwiseProduct((gradient.array() - gradient.dot(h)).matrix()).eval();
        return value;
    };
}

struct Optimum {
    VectorXd h;
    int evaluations = 0;
    int iterations = 0;
    bool converged = true;
};

Optimum least(const Energy& energy, const VectorXd& start, double tolerance, int evaluations) {
    const Minimum minimum = minimise(in_logarithms(energy), start.array().log(), tolerance, evaluations);
    return {normalised((minimum.x.array() - minimum.x.maxCoeff()).exp()), minimum.evaluations, 0, minimum.converged};
}

/// Least p-norm of the accelerations with p growing: each minimum starts the next. The last is within log(K N) / p of
/// the least maximum.
Optimum least_peak(const Bending& bending, const VectorXd& start, double tolerance, int evaluations) {
    constexpr double kFirst = 4, kLast = 1 << 22, kGrowth = 4;
    Optimum at{start, 0, 0, true};
    for (double p = kFirst; p <= kLast; p *= kGrowth) {
        const auto energy = [&](const VectorXd& h, VectorXd* gradient) { return bending.log_peak(h, p, gradient); };
        Optimum next = least(energy, at.h, std::max(tolerance, 1e-9), std::max(1, evaluations - at.evaluations));
        next.evaluations += at.evaluations;
        at = std::move(next);
    }
    return at;
}

/// (30), with the line search that the paper asks for.
Optimum gradient_projection(const Energy& energy, const VectorXd& start, double tolerance, int evaluations) {
    Optimum at{start, 1, 0, false};
    VectorXd gradient(start.size());
    double value = energy(at.h, &gradient);
    while (at.evaluations < evaluations && !at.converged) {
        const VectorXd d = gradient.array() - gradient.mean();
        if (d.isZero(0)) {
            at.converged = true;
            break;
        }
        const double highest = 1 / (d.array() / at.h.array()).maxCoeff();  // above 0: d has mean 0
        const double lambda = golden_section([&](double l) { return energy(at.h - l * d, nullptr); }, 0, highest);
        const VectorXd h = normalised(at.h - lambda * d);
        VectorXd next_gradient(h.size());
        const double next = energy(h, &next_gradient);
        ++at.iterations;
        ++at.evaluations;
        at.converged = !(value - next > tolerance * std::abs(value));
        if (next < value) {
            at.h = h, value = next, gradient = next_gradient;
        }
    }
    return at;
}

/// True when the splines over the chord length are straight to rounding: G = 0 can't be bettered.
bool is_straight(const Bending& bending, const VectorXd& chord, double length) {
    const auto bends = bending.largest(chord);
    const double n = static_cast<double>(chord.size());
    return *std::max_element(bends.begin(), bends.end()) <= 1e-12 * length * n * n;
}

Optimum optimise(const MatrixXd& z, const Bending& weighted, const Bending& limited, const VectorXd& chord,
                 const ParametrizeOptions& options) {
    if (is_straight(weighted, chord, distances(z).sum())) {
        return {chord};
    }
    if (options.objective == Objective::minimax) {
        return least_peak(limited, chord, options.tolerance, options.max_evaluations);
    }
    if (options.objective == Objective::exact && z.cols() == 1 && options.solver == Solver::lbfgs) {
        return {closed_form_spacing(std::span(z.data(), static_cast<std::size_t>(z.rows())))};
    }
    const Energy energy = options.objective == Objective::exact
                              ? Energy([&](const auto& h, auto* gradient) { return weighted.exact(h, gradient); })
                              : Energy([&](const auto& h, auto* gradient) { return weighted.diagonal(h, gradient); });
    return options.solver == Solver::lbfgs
               ? least(energy, chord, options.tolerance, options.max_evaluations)
               : gradient_projection(energy, chord, options.tolerance, options.max_evaluations);
}

Parametrization described(const Optimum& optimum, const Bending& bending, const std::vector<double>& limits) {
    Parametrization result;
    result.t.push_back(0);
    double sum = 0;
    for (Index i = 0; i < optimum.h.size(); ++i) {
        sum += optimum.h[i];
        result.t.push_back(i + 1 < optimum.h.size() ? sum : 1);
        if (!(result.t.end()[-1] > result.t.end()[-2])) {
            throw InputError("parametrize: rows " + std::to_string(i + 1) + " and " + std::to_string(i + 2) +
                             " are too close together, against the size of the whole, to be told apart; remove one");
        }
    }
    result.exact_energy = bending.exact(optimum.h);
    result.diagonal_energy = bending.diagonal(optimum.h);
    result.max_acceleration = bending.largest(optimum.h);
    for (std::size_t k = 0; k < limits.size(); ++k) {
        result.peak = std::max(result.peak, result.max_acceleration[k] / limits[k]);
    }
    result.evaluations = optimum.evaluations;
    result.iterations = optimum.iterations;
    result.converged = optimum.converged;
    return result;
}

}  // namespace

std::optional<std::size_t> first_repeated(std::span<const VectorXd> points) {
    const auto found = std::adjacent_find(points.begin(), points.end());
    return found == points.end() ? std::nullopt : std::optional(static_cast<std::size_t>(found - points.begin()));
}

VectorXd closed_form_spacing(std::span<const double> z) {
    ensure(z.size() >= 2, "two ordinates at least");
    std::vector<std::size_t> turn{0};  // i_0 ... i_M
    for (std::size_t i = 1; i + 1 < z.size(); ++i) {
        if ((z[i] > z[i - 1]) != (z[i + 1] > z[i])) {
            turn.push_back(i);
        }
    }
    turn.push_back(z.size() - 1);
    VectorXd t(static_cast<Index>(z.size()));
    double start = 0;
    const std::size_t m = turn.size() - 1;
    for (std::size_t k = 0; k < m; ++k) {
        const double d = z[turn[k + 1]] - z[turn[k]];
        const bool first = k == 0, last = k + 1 == m;
        const double length = (first || last ? 1 : std::numbers::sqrt2) * std::sqrt(std::abs(d));
        // Where psi reaches the share f of the rise: it is bent at inner turns only, where its slope is 0.
        const auto free_to_turn = [](double f) { return 2 * std::sin(std::asin(f) / 3); };
        const auto turn_to_turn = [](double f) {
            const double b = 2 * std::asin(std::sqrt(f)) / 3;
            return std::pow(std::sin(b / 2), 2) + std::numbers::sqrt3 / 2 * std::sin(b);
        };
        for (std::size_t j = turn[k]; j <= turn[k + 1]; ++j) {
            const double f = (z[j] - z[turn[k]]) / d, g = (z[turn[k + 1]] - z[j]) / d;
            const double share = first && last ? f
                                 : first       ? free_to_turn(f)
                                 : last        ? 1 - free_to_turn(g)
                                 : f < 0.5     ? turn_to_turn(f)
                                               : 1 - turn_to_turn(g);
            t[static_cast<Index>(j)] = start + length * share;
        }
        start += length;
    }
    return normalised(t.tail(t.size() - 1) - t.head(t.size() - 1));
}

Parametrization parametrize(std::span<const VectorXd> points, const ParametrizeOptions& options) {
    check(points, options);
    MatrixXd z(static_cast<Index>(points.size()), points[0].size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        z.row(static_cast<Index>(i)) = points[i].transpose();
    }
    const auto alpha = or_ones(options.weights, {}, z.cols());
    const auto limits = or_ones(options.limits, options.weights, z.cols());
    const Bending bending(z, alpha);
    const VectorXd chord = normalised(distances(z));
    switch (options.objective) {
        case Objective::chord:
            return described({chord}, bending, limits);
        case Objective::centripetal:
            return described({normalised(chord.cwiseSqrt())}, bending, limits);
        case Objective::foley:
            return described({normalised(foley_spacing(z))}, bending, limits);
        default:
            return described(optimise(z, bending, Bending(z, limits), chord, options), bending, limits);
    }
}

}  // namespace seampath
