#pragma once

#include <span>
#include <vector>

namespace seampath {

/// LU factors of a tridiagonal matrix without pivoting: the Thomas algorithm, O(n). The matrix must be diagonally
/// dominant, as those of cubic splines are.
class Tridiagonal {
public:
    /// Row i is lower[i], diagonal[i], upper[i]; lower[0] and upper[n - 1] are not used. All of the same length.
    Tridiagonal(std::span<const double> lower, std::span<const double> diagonal, std::span<const double> upper);

    /// Replaces a right side by the solution.
    void solve(std::span<double> right) const;

private:
    std::vector<double> lower_;
    std::vector<double> pivot_;
    std::vector<double> upper_;  ///< divided by the pivot
};

/// Solves the system that also has lower[0] in the last column of row 0 and upper[n - 1] in column 0 of the last row,
/// by the Sherman-Morrison formula. n is at least 3.
std::vector<double> solve_cyclic(std::span<const double> lower, std::span<const double> diagonal,
                                 std::span<const double> upper, std::span<const double> right);

}  // namespace seampath
