#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

/// Interpolation of values at equal steps by finite differences: Minejeva & Markovics, Choice of interpolation method
/// for an arbitrary arc welding curve, sections V and VI. U = (x - x_0) / h; x_0 is the node that a formula starts
/// from.
namespace seampath {

enum class Formula { newton_forward, newton_backward, stirling, bessel };
inline constexpr std::array<std::string_view, 4> kFormulaNames{"newton-forward", "newton-backward", "stirling",
                                                               "bessel"};
inline std::string_view name(Formula formula) {
    return kFormulaNames[static_cast<std::size_t>(formula)];
}

/// Finite differences of table I, (4) and (5).
class DifferenceTable {
public:
    /// At least two values, abscissae ascending; differences up to `max_order` or as far as the values go. Throws
    /// InputError with the rows when the steps differ by more than 1e-9 of the step and what rounding leaves.
    DifferenceTable(std::span<const double> x, std::span<const double> y, std::size_t max_order);

    std::size_t nodes() const { return column_[0].size(); }
    std::size_t max_order() const { return column_.size() - 1; }
    double step() const { return step_; }
    double x(std::size_t i) const { return x_[i]; }
    /// Delta^order y_i; order 0 is y_i itself.
    double operator()(std::size_t order, std::size_t i) const { return column_[order][i]; }
    /// Index of the interval, from x_i to x_{i+1}, that holds x; the first or last one outside.
    std::size_t interval(double x) const;

private:
    std::vector<double> x_;
    double step_;
    std::vector<std::vector<double>> column_;
};

/// A formula as it is used for one x.
struct Placement {
    Formula formula = Formula::newton_forward;
    std::size_t origin = 0;  ///< index of x_0
    double u = 0;            ///< U
    std::size_t degree = 0;  ///< of the polynomial
};

/// Where section VI puts x_0 for a formula, of a degree of at most `degree` (at least 1): Newton I at the node before
/// x, Newton II at the one after, Stirling at the nearest, Bessel at the node before. Where the differences of that
/// degree are missing there, x_0 moves along the table to the nearest node that has them, so the polynomial always
/// passes through the nodes on both sides of x. Stirling's degree is even, Bessel's odd; a table too short for Stirling
/// is served by Newton I.
Placement place(const DifferenceTable& table, Formula formula, double x, std::size_t degree);

/// The formula that section VI recommends for x: in central intervals Stirling's for U up to 0.25 from either node and
/// Bessel's between, where they have all their differences and a degree of 2 at least; else Newton I in the upper half
/// of the table and Newton II in the lower.
Placement choose(const DifferenceTable& table, double x, std::size_t degree);

/// The polynomial by (9), (11), (12) or (13). The last term of (13) is over (2n+1)!, with Delta^{2n+1} y_{-n}.
double value(const DifferenceTable& table, const Placement& at);

/// The products of U over the factorial in (14)-(17): times h^{n+1} y^{(n+1)}(xi) it is the error y - P, n the degree.
/// (14) is over (n+1)!, not (n-1)! as printed.
double error_factor(const Placement& at);

/// |error| with the largest of the next differences beside x_0 in place of h^{n+1} y^{(n+1)}(xi); nothing when the
/// table is too short to have one.
std::optional<double> estimated_error(const DifferenceTable& table, const Placement& at);

}  // namespace seampath
