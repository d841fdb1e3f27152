#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace seampath {

/// How hard the natural cubic splines through K-dimensional points z_0 ... z_N bend, as a function of the spacing
/// h_1 ... h_N of the parameter: Marin, An approach to data parametrization in parametric cubic spline interpolation
/// problems, J. Approx. Theory 41 (1984), section 3. With M and Q of (31), S = M^-1 Q z holds the second derivatives at
/// the interior points, S_0 = S_N = 0. Everything takes O(K N).
class Bending {
public:
    /// Points as rows, one column a coordinate; one alpha a coordinate, positive.
    Bending(const Eigen::MatrixXd& z, std::span<const double> alpha);

    Eigen::Index intervals() const { return difference_.rows(); }

    /// (31): the sum over the coordinates of the integral of theta''^2, over alpha^2. Fills dG/dh when asked to: the
    /// derivative for h_k is 2 D_k / h_k^2 (S_k - S_{k-1}) - (S_k^2 + S_k S_{k-1} + S_{k-1}^2) / 3, D_k = z_k -
    /// z_{k-1}.
    double exact(const Eigen::VectorXd& h, Eigen::VectorXd* gradient = nullptr) const;

    /// (34): the same with M cut down to its diagonal.
    double diagonal(const Eigen::VectorXd& h, Eigen::VectorXd* gradient = nullptr) const;

    /// Logarithm of the p-norm of all |theta''| / alpha at the points. theta'' is linear in between, so for a large p
    /// this is the logarithm of the largest acceleration over its limit: at most log(K N) / p above it.
    double log_peak(const Eigen::VectorXd& h, double p, Eigen::VectorXd* gradient = nullptr) const;

    /// Largest |theta''| of each coordinate, not divided by alpha.
    std::vector<double> largest(const Eigen::VectorXd& h) const;

private:
    Eigen::MatrixXd jumps(const Eigen::VectorXd& h) const;
    Eigen::VectorXd gradient_of(const Eigen::VectorXd& h, const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                                const Eigen::MatrixXd& s, double coupling) const;

    Eigen::MatrixXd difference_;  ///< D_k as rows
    Eigen::RowVectorXd alpha_;
};

}  // namespace seampath
