#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include <Eigen/Core>

namespace seampath {

/// Nonlinear least squares whose residuals come in blocks (a pose, a picture): all blocks share some parameters, and
/// each has as many more of its own, or none.
struct BlockProblem {
    std::size_t blocks = 0;
    Eigen::VectorXd shared_unit;  ///< one a shared parameter: a change of it that matters little, for derivatives
    Eigen::VectorXd own_unit;     ///< the same of each block's own parameters; may be empty
    /// Residuals of a block over their sigmas, as many whatever the parameters.
    std::function<Eigen::VectorXd(std::size_t block, const Eigen::VectorXd& shared, const Eigen::VectorXd& own)>
        residuals;
};

/// What one block says of the shared parameters near the fit, its own being as they fit best.
struct BlockShare {
    Eigen::MatrixXd H;  ///< information
    Eigen::VectorXd g;  ///< half the gradient of its chi-squared
    double chi2 = 0;
    Eigen::Index count = 0;  ///< residuals less own parameters
};

struct BlockFit {
    Eigen::VectorXd shared;
    std::vector<Eigen::VectorXd> own;  ///< one a block
    std::vector<BlockShare> blocks;
    Eigen::MatrixXd information;  ///< of the shared parameters, their own being free
    double chi2 = 0;
    Eigen::Index redundancy = 0;  ///< residuals less parameters
    bool converged = false;

    /// Inverse of the information: the covariance of the shared parameters where the sigmas are true.
    Eigen::MatrixXd covariance() const;
    /// chi2 over the redundancy: about 1 where the sigmas are true. 1 where nothing is redundant.
    double variance_factor() const;
};

/// Levenberg and Marquardt's method with central differences; each block's own parameters are eliminated (Schur
/// complement), so that the cost grows with the blocks only. Sums are in the order of the blocks.
BlockFit fit_blocks(const BlockProblem& problem, Eigen::VectorXd shared, std::vector<Eigen::VectorXd> own);

/// What the fit would be without one block, to first order.
struct WithoutBlock {
    Eigen::VectorXd step;  ///< from the fit's shared parameters
    double chi2 = 0;
    double p_value = 1;  ///< of an F test: that chance alone sets the block this far from the others
};
WithoutBlock without_block(const BlockFit& fit, std::size_t block);

}  // namespace seampath
