#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "stages/geometry/differences.hpp"
#include "stages/geometry/parametrize.hpp"
#include "stages/geometry/piecewise_cubic.hpp"

/// Interpolation of a table by the methods that Minejeva & Markovics, Choice of interpolation method for an arbitrary
/// arc welding curve, compare, and by those that serve better.
namespace seampath {

enum class Method {
    newton_forward,   ///< Newton I (9), equal steps
    newton_backward,  ///< Newton II (11), equal steps
    stirling,         ///< (12), equal steps
    bessel,           ///< (13), equal steps
    classical,        ///< at each x that one of the four that section VI recommends
    lagrange,         ///< through the nodes around x
    newton_divided,   ///< the same polynomial by divided differences
    natural,          ///< cubic splines: section VIII
    clamped,
    not_a_knot,
    periodic,
    akima,
    pchip,
    linear,
    parametric  ///< natural cubic splines x(t), y(t), t by paper of Marin (parametrize.hpp)
};
inline constexpr std::array<std::string_view, 15> kMethodNames{
    "newton-forward", "newton-backward", "stirling", "bessel", "classical", "lagrange", "newton-divided", "natural",
    "clamped",        "not-a-knot",      "periodic", "akima",  "pchip",     "linear",   "parametric"};
inline std::string_view name(Method method) {
    return kMethodNames[static_cast<std::size_t>(method)];
}

/// Higher degrees than this are noise in double precision.
inline constexpr std::size_t kMaxDegree = 40;

struct InterpolateOptions {
    std::size_t degree = 5;             ///< of the polynomials, at most; 1..kMaxDegree. No more than 5: section VII
    bool split_at_inflections = false;  ///< polynomials end at inflection points instead of reaching across
    std::optional<std::array<double, 2>> end_slopes;  ///< of `clamped`; without: of parabolas through three nodes
    Objective parametrization = Objective::chord;     ///< of `parametric`
};

/// The value at one x and how a formula came to it.
struct Evaluation {
    double y = 0;
    std::optional<Placement> placement;     ///< of the finite-difference formulas; counts nodes within the part
    std::optional<double> estimated_error;  ///< (14)-(17), where the table has the differences
};

/// A line through all nodes of a table, and how to walk along it. Holds all it needs.
struct Interpolant {
    Method method = Method::linear;
    std::vector<double> t;  ///< parameter at each node: its x, or that of `parametric`
    std::function<Eigen::Vector2d(double t)> at;
    std::function<Evaluation(double x)> evaluate;  ///< throws InputError outside the table
    std::optional<PiecewiseCubic> cubic;           ///< y(x), of the splines

    double value(double x) const { return evaluate(x).y; }
};

/// Index i of the first x that is not below x_{i+1}, if any.
std::optional<std::size_t> first_not_ascending(std::span<const double> x);

/// Throws InputError when there are fewer than two rows, x doesn't ascend (with the rows, from 1), a value is not
/// finite, or the method can't serve the table: steps not equal, ends that differ or fewer than four rows for
/// `periodic`.
Interpolant interpolate(Method method, std::span<const double> x, std::span<const double> y,
                        const InterpolateOptions& options);

/// Where the curve behind a table turns from bending one way to bending the other.
struct Inflection {
    double x = 0;          ///< zero of the second divided differences
    std::size_t node = 0;  ///< the inner node nearest to it, where a table is split
};

/// From changes of sign of the second divided differences, rounding counted as zero; ascending, one a node.
std::vector<Inflection> inflections(std::span<const double> x, std::span<const double> y);

}  // namespace seampath
