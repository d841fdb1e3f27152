#include <random>

#include <gtest/gtest.h>

#include "stages/geometry/lbfgs.hpp"
#include "stages/geometry/tridiagonal.hpp"

namespace seampath {
namespace solvers_test {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct System {
    std::vector<double> lower, diagonal, upper, right;

    System(std::size_t n, std::mt19937& random) {
        std::uniform_real_distribution<double> any(-1, 1);
        for (std::size_t i = 0; i < n; ++i) {
            lower.push_back(any(random)), upper.push_back(any(random)), right.push_back(any(random));
            diagonal.push_back(std::copysign(2.5, any(random)));
        }
    }

    MatrixXd matrix(bool cyclic) const {
        const auto n = static_cast<Eigen::Index>(diagonal.size());
        MatrixXd m = MatrixXd::Zero(n, n);
        for (Eigen::Index i = 0; i < n; ++i) {
            const auto k = static_cast<std::size_t>(i);
            m(i, i) = diagonal[k];
            if (cyclic || i > 0) {
                m(i, (i + n - 1) % n) = lower[k];
            }
            if (cyclic || i + 1 < n) {
                m(i, (i + 1) % n) = upper[k];
            }
        }
        return m;
    }

    double residual(const std::vector<double>& x, bool cyclic) const {
        const auto n = static_cast<Eigen::Index>(x.size());
        return (matrix(cyclic) * Eigen::Map<const VectorXd>(x.data(), n) - Eigen::Map<const VectorXd>(right.data(), n))
            .cwiseAbs()
            .maxCoeff();
    }
};

TEST(Tridiagonal, SolvesDominantSystems) {
    std::mt19937 random(1);
    for (const std::size_t n : {0u, 1u, 2u, 3u, 50u}) {
        const System system(n, random);
        auto x = system.right;
        Tridiagonal(system.lower, system.diagonal, system.upper).solve(x);
        if (n > 0) {
            EXPECT_LT(system.residual(x, false), 1e-14) << n;
        }
    }
}

TEST(Tridiagonal, SolvesCyclicSystems) {
    std::mt19937 random(2);
    for (const std::size_t n : {3u, 4u, 50u}) {
        const System system(n, random);
        EXPECT_LT(system.residual(solve_cyclic(system.lower, system.diagonal, system.upper, system.right), true), 1e-13)
            << n;
    }
}

double rosenbrock(const VectorXd& x, VectorXd& gradient) {
    const double a = 1 - x[0], b = x[1] - x[0] * x[0];
    gradient = Eigen::Vector2d(-2 * a - 400 * x[0] * b, 200 * b);
    return 1 + a * a + 100 * b * b;
}

TEST(Lbfgs, FindsTheEndOfTheCurvedValley) {
    const Minimum minimum = minimise(rosenbrock, Eigen::Vector2d(-1.2, 1), 1e-14, 200);
    EXPECT_TRUE(minimum.converged);
    EXPECT_NEAR(minimum.value, 1, 1e-13);
    EXPECT_NEAR((minimum.x - Eigen::Vector2d(1, 1)).norm(), 0, 1e-6);
    EXPECT_LT(minimum.evaluations, 80);
}

TEST(Lbfgs, SaysWhenEvaluationsEnd) {
    const Minimum minimum = minimise(rosenbrock, Eigen::Vector2d(-1.2, 1), 1e-14, 10);
    EXPECT_FALSE(minimum.converged);
    EXPECT_EQ(minimum.evaluations, 10);
}

TEST(Lbfgs, StaysAtAMinimumAndOutOfWhereTheFunctionEnds) {
    const Minimum still = minimise(rosenbrock, Eigen::Vector2d(1, 1), 1e-12, 50);
    EXPECT_TRUE(still.converged);
    EXPECT_EQ(still.x, Eigen::Vector2d(1, 1));
    const auto barrier = [](const VectorXd& x, VectorXd& gradient) {
        gradient = VectorXd::Constant(1, 1 - 1 / x[0]);
        return x[0] - std::log(x[0]);  // not a number below 0
    };
    EXPECT_NEAR(minimise(barrier, VectorXd::Constant(1, 0.01), 1e-14, 100).x[0], 1, 1e-6);
}

}  // namespace solvers_test
}  // namespace seampath
