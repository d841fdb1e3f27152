#include "stages/geometry/banded.hpp"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "datasets/rng.hpp"

namespace seampath {
namespace banded_test {

// The same sums of squares in a full matrix.
TEST(BandedMatrix, SolvesAndInvertsAsAFullOneDoes) {
    for (const bool cyclic : {false, true}) {
        for (const std::size_t n : {4, 5, 6, 7, 8, 9, 30, 31}) {
            const Random random(n, cyclic);
            BandedMatrix banded(n, cyclic);
            Eigen::MatrixXd full = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n));
            std::vector<BandedMatrix::Four> groups;
            for (std::size_t k = 0; k < 3 * n; ++k) {
                const std::size_t first = k % (cyclic ? n : n - 3);
                groups.push_back({first, (first + 1) % n, (first + 2) % n, (first + 3) % n});
                BandedMatrix::Values v;
                Eigen::VectorXd whole = Eigen::VectorXd::Zero(full.rows());
                for (std::size_t r = 0; r < 4; ++r) {
                    v[r] = random.normal(4 * k + r);
                    whole[static_cast<Eigen::Index>(groups.back()[r])] = v[r];
                }
                banded.add_square(groups.back(), v, 0.5 + static_cast<double>(k));
                full += (0.5 + static_cast<double>(k)) * whole * whole.transpose();
            }
            EXPECT_NEAR(banded.mean_diagonal(), full.trace() / static_cast<double>(n), 1e-9);
            const BandedMatrix before = banded;
            ASSERT_TRUE(banded.factorise());
            const Eigen::MatrixXd V = full.inverse();
            const BandedMatrix inverse = banded.inverse();
            EXPECT_NEAR(inverse.trace_with(before), static_cast<double>(n), 1e-6);
            for (const BandedMatrix::Four& group : groups) {
                Eigen::Vector4d v(1, -2, 3, 0.5);
                double expected = 0;
                for (int r = 0; r < 4; ++r) {
                    for (int c = 0; c < 4; ++c) {
                        expected +=
                            v[r] * v[c] * V(static_cast<Eigen::Index>(group[r]), static_cast<Eigen::Index>(group[c]));
                    }
                }
                EXPECT_NEAR(inverse.square(group, {v[0], v[1], v[2], v[3]}), expected, 1e-8 * (1 + expected));
            }
            std::vector<Eigen::RowVector3d> right(n);
            Eigen::MatrixX3d b(full.rows(), 3);
            for (std::size_t i = 0; i < n; ++i) {
                right[i] = Eigen::RowVector3d(random.normal(9000 + i), 1, static_cast<double>(i));
                b.row(static_cast<Eigen::Index>(i)) = right[i];
            }
            const Eigen::MatrixX3d x = V * b;
            const std::vector<Eigen::RowVector3d> solved = banded.solve(right);
            for (std::size_t i = 0; i < n; ++i) {
                EXPECT_LT((solved[i] - x.row(static_cast<Eigen::Index>(i))).norm(), 1e-8 * (1 + x.norm()));
            }
        }
    }
}

TEST(BandedMatrix, RefusesWhatIsNotPositiveDefinite) {
    BandedMatrix matrix(6, false);
    matrix.add_square({0, 1, 2, 3}, {1, 1, 1, 1}, 1);
    EXPECT_FALSE(matrix.factorise());
}

}  // namespace banded_test
}  // namespace seampath
