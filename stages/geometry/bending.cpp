#include "stages/geometry/bending.hpp"

#include <cmath>
#include <limits>

#include "stages/error.hpp"
#include "stages/geometry/tridiagonal.hpp"

namespace seampath {
namespace {

using Eigen::ArrayXXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

/// M^-1 times the rows of the interior points; the rows of the ends stay zero.
MatrixXd solved(const VectorXd& h, MatrixXd right) {
    const Index n = h.size() - 1;
    const VectorXd diagonal = (h.head(n) + h.tail(n)) / 3, lower = h.head(n) / 6, upper = h.tail(n) / 6;
    const auto size = static_cast<std::size_t>(n);
    const Tridiagonal mass({lower.data(), size}, {diagonal.data(), size}, {upper.data(), size});
    for (Index k = 0; k < right.cols(); ++k) {
        mass.solve({right.col(k).data() + 1, size});
    }
    return right;
}

}  // namespace

Bending::Bending(const MatrixXd& z, std::span<const double> alpha)
    : difference_(z.bottomRows(z.rows() - 1) - z.topRows(z.rows() - 1)),
      alpha_(Eigen::Map<const RowVectorXd>(alpha.data(), static_cast<Index>(alpha.size()))) {
    ensure(z.rows() >= 2 && alpha_.size() == z.cols(), "two points, and an alpha for each coordinate");
}

// Q z, with a row of zeros for either end, like all matrices over the points below.
MatrixXd Bending::jumps(const VectorXd& h) const {
    const MatrixXd slope = h.cwiseInverse().asDiagonal() * difference_;
    const Index n = intervals();
    MatrixXd jump = MatrixXd::Zero(n + 1, slope.cols());
    jump.middleRows(1, n - 1) = slope.bottomRows(n - 1) - slope.topRows(n - 1);
    return jump;
}

/// Gradient of a'Q z - b'M s, a, b and s held fixed, summed over the coordinates. `coupling` is M's off-diagonal as a
/// multiple of h: 1/6, or 0 for the diagonal alone.
VectorXd Bending::gradient_of(const VectorXd& h, const MatrixXd& a, const MatrixXd& b, const MatrixXd& s,
                              double coupling) const {
    const Index n = intervals();
    const auto sum_of = [](const auto& x, const auto& y) { return x.cwiseProduct(y).rowwise().sum(); };
    const VectorXd own = sum_of(b, s);
    VectorXd gradient = -(own.head(n) + own.tail(n)) / 3;
    gradient += sum_of(difference_, a.bottomRows(n) - a.topRows(n)).cwiseQuotient(h.cwiseAbs2());
    gradient -= coupling * (sum_of(b.topRows(n), s.bottomRows(n)) + sum_of(b.bottomRows(n), s.topRows(n)));
    return gradient;
}

double Bending::exact(const VectorXd& h, VectorXd* gradient) const {
    const MatrixXd jump = jumps(h);
    const MatrixXd s = solved(h, jump);
    const MatrixXd weighted = s * alpha_.cwiseAbs2().cwiseInverse().asDiagonal();
    if (gradient) {
        *gradient = gradient_of(h, 2 * weighted, weighted, s, 1.0 / 6);
    }
    return weighted.cwiseProduct(jump).sum();
}

double Bending::diagonal(const VectorXd& h, VectorXd* gradient) const {
    const Index n = intervals() - 1;
    MatrixXd s = jumps(h);
    const MatrixXd jump = s;
    s.middleRows(1, n).array().colwise() *= 3 / (h.head(n) + h.tail(n)).array();
    const MatrixXd weighted = s * alpha_.cwiseAbs2().cwiseInverse().asDiagonal();
    if (gradient) {
        *gradient = gradient_of(h, 2 * weighted, weighted, s, 0);
    }
    return weighted.cwiseProduct(jump).sum();
}

double Bending::log_peak(const VectorXd& h, double p, VectorXd* gradient) const {
    const MatrixXd s = solved(h, jumps(h));
    const ArrayXXd share = (s * alpha_.cwiseInverse().asDiagonal()).array();
    const double peak = share.abs().maxCoeff();
    if (peak == 0) {
        if (gradient) {
            gradient->setZero();
        }
        return -std::numeric_limits<double>::infinity();
    }
    const ArrayXXd ratio = share / peak;
    // |ratio|^(p - 1); below exp(-300) it is nothing beside the largest, 1, and numbers near underflow are slow.
    const ArrayXXd power = ((p - 1) * ratio.abs().max(1e-300).log()).max(-300).exp();
    const double sum = (power * ratio.abs()).sum();
    if (gradient) {
        // d log(peak) / dS, then the adjoint of M S = Q z
        const MatrixXd slope = (power * ratio.sign() / (peak * sum)).matrix() * alpha_.cwiseInverse().asDiagonal();
        const MatrixXd lambda = solved(h, slope);
        *gradient = gradient_of(h, lambda, lambda, s, 1.0 / 6);
    }
    return std::log(peak) + std::log(sum) / p;
}

std::vector<double> Bending::largest(const VectorXd& h) const {
    const RowVectorXd largest = solved(h, jumps(h)).cwiseAbs().colwise().maxCoeff();
    return {largest.begin(), largest.end()};
}

}  // namespace seampath
