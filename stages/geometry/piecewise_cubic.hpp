#pragma once

#include <span>
#include <vector>

/// Interpolation by a cubic polynomial between every two nodes: Minejeva & Markovics, Choice of interpolation method
/// for an arbitrary arc welding curve, section VIII. Nodes ascend, at least two of them; every method has as many
/// values.
namespace seampath {

/// f(x) = a_i + b_i (x - x_{i-1}) + c_i (x - x_{i-1})^2 + d_i (x - x_{i-1})^3 for x_{i-1} <= x <= x_i, (20); the print
/// lacks d_i. Outside the nodes the first or last polynomial goes on.
struct PiecewiseCubic {
    std::vector<double> x;           ///< nodes, one more than polynomials
    std::vector<double> a, b, c, d;  ///< one an interval

    double value(double at) const;
    double slope(double at) const;   ///< (24)
    double second(double at) const;  ///< second derivative, (25)
};

/// Two continuous derivatives and no bending at the ends: (30)-(37), solved by the Thomas algorithm. (30) and (31) are
/// conditions on the second derivative.
PiecewiseCubic natural_spline(std::span<const double> x, std::span<const double> y);

/// Two continuous derivatives and given slopes at the ends.
PiecewiseCubic clamped_spline(std::span<const double> x, std::span<const double> y, double first_slope,
                              double last_slope);

/// Two continuous derivatives, and a third one that is continuous at the second and the last node but one. Two nodes
/// give a line, three a parabola.
PiecewiseCubic not_a_knot_spline(std::span<const double> x, std::span<const double> y);

/// Two continuous derivatives, also from the end to the beginning. At least four nodes, y[0] = y[n].
PiecewiseCubic periodic_spline(std::span<const double> x, std::span<const double> y);

/// Slopes from the two chords on either side of a node, weighted by how little the chords beyond turn: Akima, J. ACM 17
/// (1970).
PiecewiseCubic akima_spline(std::span<const double> x, std::span<const double> y);

/// Monotone between every two nodes: slopes by the weighted harmonic mean of Fritsch & Butland (1984), with the ends of
/// Moler, Numerical Computing with MATLAB, 3.6.
PiecewiseCubic pchip_spline(std::span<const double> x, std::span<const double> y);

/// The polygon.
PiecewiseCubic linear_spline(std::span<const double> x, std::span<const double> y);

}  // namespace seampath
