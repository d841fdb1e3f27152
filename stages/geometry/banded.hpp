#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace seampath {

/// Symmetric positive definite matrix in which only unknowns at most three apart, in a row or (cyclic) in a ring, have
/// to do with each other: the normal matrix of a cubic spline. Everything takes O(n). A ring is folded flat (0, n-1, 1,
/// n-2, ...), which makes it a band almost twice as wide.
class BandedMatrix {
public:
    using Four = std::array<std::size_t, 4>;
    using Values = std::array<double, 4>;

    BandedMatrix(std::size_t n, bool cyclic);

    /// Adds factor * v v' for four unknowns next to each other.
    void add_square(const Four& unknown, const Values& v, double factor);
    /// v' M v for four unknowns next to each other.
    double square(const Four& unknown, const Values& v) const;
    double mean_diagonal() const;
    /// Trace of the product with a matrix of the same shape.
    double trace_with(const BandedMatrix& other) const;

    /// Replaces the matrix by its factors L D L' (Cholesky's without square roots); after this only `solve` and
    /// `inverse` make sense. False when it is not positive definite to rounding.
    bool factorise();
    /// Solves for three right sides, one row per unknown.
    std::vector<Eigen::RowVector3d> solve(const std::vector<Eigen::RowVector3d>& right) const;
    /// The entries of the inverse inside the band, from the factors (Takahashi, Fagan & Chin 1973; Erisman & Tinney
    /// 1975).
    BandedMatrix inverse() const;

private:
    std::size_t fold(std::size_t i) const { return !cyclic_ ? i : i < (n_ + 1) / 2 ? 2 * i : 2 * (n_ - 1 - i) + 1; }
    // Row i holds the columns i - width + 1 ... i; those before column 0 stay zero.
    double& at(std::size_t i, std::size_t j) { return value_[i * width_ + (j + width_ - 1 - i)]; }
    double at(std::size_t i, std::size_t j) const { return value_[i * width_ + (j + width_ - 1 - i)]; }
    std::size_t first_in_row(std::size_t i) const { return i < width_ ? 0 : i - width_ + 1; }

    std::size_t n_;
    bool cyclic_;
    std::size_t width_;  ///< of the lower half of the band, with the diagonal
    std::vector<double> value_;
};

}  // namespace seampath
