#include "stages/geometry/tridiagonal.hpp"

#include "stages/error.hpp"

namespace seampath {

Tridiagonal::Tridiagonal(std::span<const double> lower, std::span<const double> diagonal, std::span<const double> upper)
    : lower_(lower.begin(), lower.end()), pivot_(diagonal.begin(), diagonal.end()), upper_(upper.begin(), upper.end()) {
    ensure(lower.size() == diagonal.size() && upper.size() == diagonal.size(), "the three diagonals are as long");
    for (std::size_t i = 0; i < pivot_.size(); ++i) {
        if (i > 0) {
            pivot_[i] -= lower_[i] * upper_[i - 1];
        }
        upper_[i] /= pivot_[i];
    }
}

void Tridiagonal::solve(std::span<double> right) const {
    ensure(right.size() == pivot_.size(), "the right side has a row for each row of the matrix");
    for (std::size_t i = 0; i < right.size(); ++i) {
        right[i] = (right[i] - (i > 0 ? lower_[i] * right[i - 1] : 0)) / pivot_[i];
    }
    for (std::size_t i = right.size(); i-- > 1;) {
        right[i - 1] -= upper_[i - 1] * right[i];
    }
}

std::vector<double> solve_cyclic(std::span<const double> lower, std::span<const double> diagonal,
                                 std::span<const double> upper, std::span<const double> right) {
    const std::size_t n = diagonal.size();
    ensure(n >= 3, "a cyclic system has at least three rows");
    // A = B + u v', u = (gamma, 0, ..., upper[n-1]), v = (1, 0, ..., lower[0] / gamma), and B tridiagonal.
    const double gamma = -diagonal[0];
    const double corner = lower[0] / gamma;
    std::vector<double> b(diagonal.begin(), diagonal.end());
    b[0] -= gamma;
    b[n - 1] -= upper[n - 1] * corner;
    const Tridiagonal matrix(lower, b, upper);
    std::vector<double> x(right.begin(), right.end());
    std::vector<double> q(n, 0);
    q[0] = gamma;
    q[n - 1] = upper[n - 1];
    matrix.solve(x);
    matrix.solve(q);
    const double factor = (x[0] + corner * x[n - 1]) / (1 + q[0] + corner * q[n - 1]);
    for (std::size_t i = 0; i < n; ++i) {
        x[i] -= factor * q[i];
    }
    return x;
}

}  // namespace seampath
