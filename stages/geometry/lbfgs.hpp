#pragma once

#include <functional>

#include <Eigen/Core>

namespace seampath {

/// Value at x; fills the gradient, which has the size of x. Not finite where the function isn't defined.
using Differentiable = std::function<double(const Eigen::VectorXd& x, Eigen::VectorXd& gradient)>;

struct Minimum {
    Eigen::VectorXd x;
    double value = 0;
    int evaluations = 0;     ///< of value and gradient together
    bool converged = false;  ///< the decrease still to be had was within the tolerance
};

/// Local minimum by the limited-memory BFGS method (Nocedal & Wright, Numerical Optimization, alg. 7.4 and 7.5), with
/// the bisecting line search for the weak Wolfe conditions of Lewis & Overton (2013). Ends when the decrease that the
/// quadratic model still promises is below `tolerance` times the value, or after `max_evaluations`.
Minimum minimise(const Differentiable& f, const Eigen::VectorXd& start, double tolerance, int max_evaluations);

}  // namespace seampath
