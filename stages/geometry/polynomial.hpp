#pragma once

#include <span>
#include <vector>

namespace seampath {

/// Newton's divided differences y[x_0], y[x_0, x_1], ... of values at distinct abscissae in any order and distance.
std::vector<double> divided_differences(std::span<const double> x, std::span<const double> y);

/// y[x_0] + y[x_0, x_1] (at - x_0) + ..., (8) with divided differences.
double newton_value(std::span<const double> x, std::span<const double> differences, double at);

/// The same polynomial by Lagrange's formula in its barycentric form (Berrut & Trefethen 2004, (4.2)), which loses no
/// digits near the nodes.
double lagrange_value(std::span<const double> x, std::span<const double> y, double at);

/// Its coefficients a_0, a_1, ... of the powers of x.
std::vector<double> power_coefficients(std::span<const double> x, std::span<const double> differences);

}  // namespace seampath
