#include "datasets/regression/frechet.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace seampath {
namespace frechet_test {

using Eigen::Vector3d;
using Points = std::vector<Vector3d>;

TEST(Frechet, OfParallelLinesIsTheirDistance) {
    const Points p{{0, 0, 0}, {3, 0, 0}, {10, 0, 0}}, q{{0, 2, 0}, {1, 2, 0}, {8, 2, 0}, {10, 2, 0}};
    EXPECT_NEAR(frechet_distance(p, q), 2, 1e-3);
    EXPECT_LT(frechet_distance(p, p), 1e-5);
}

// Every place of the zigzag is within 1 of the line, but to walk it back by 4 the dog has to go 2 on either side.
TEST(Frechet, CountsGoingBackWhichTheHausdorffDistanceDoesNot) {
    const Points line{{0, 0, 0}, {10, 0, 0}}, zigzag{{0, 0, 0}, {7, 0, 0}, {3, 0, 0}, {10, 0, 0}};
    EXPECT_NEAR(frechet_distance(line, zigzag), 2, 1e-3);
}

TEST(Frechet, OfOppositeWaysIsTheirLength) {
    const Points p{{0, 0, 0}, {10, 0, 0}}, back{{10, 0, 0}, {0, 0, 0}};
    EXPECT_NEAR(frechet_distance(p, back), 10, 1e-2);
}

TEST(Frechet, IsThatOfTheEndsWhereOneLineIsTooShort) {
    const Points p{{0, 0, 0}, {10, 0, 0}}, shorter{{0, 0.1, 0}, {7, 0.1, 0}};
    EXPECT_NEAR(frechet_distance(p, shorter), std::hypot(3, 0.1), 1e-3);
}

/// Discrete Fréchet distance (Eiter & Mannila 1994): no less than the true one, and more by at most the longest step.
double discrete(const Points& p, const Points& q) {
    std::vector<std::vector<double>> reach(p.size(), std::vector<double>(q.size()));
    for (std::size_t i = 0; i < p.size(); ++i) {
        for (std::size_t j = 0; j < q.size(); ++j) {
            const double before = i && j ? std::min({reach[i - 1][j], reach[i][j - 1], reach[i - 1][j - 1]})
                                  : i    ? reach[i - 1][j]
                                  : j    ? reach[i][j - 1]
                                         : 0;
            reach[i][j] = std::max(before, (p[i] - q[j]).norm());
        }
    }
    return reach.back().back();
}

Points refined(const Points& line, int parts) {
    Points fine;
    for (std::size_t i = 0; i + 1 < line.size(); ++i) {
        for (int k = 0; k < parts; ++k) {
            fine.push_back(line[i] + (line[i + 1] - line[i]) * k / parts);
        }
    }
    fine.push_back(line.back());
    return fine;
}

TEST(Frechet, AgreesWithTheDiscreteOneOfFineSteps) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int round = 0; round < 12; ++round) {
        Points p, q;
        for (int i = 0; i < 8; ++i) {
            p.emplace_back(i + uniform(random), 2 * uniform(random), uniform(random));
            q.emplace_back(i + uniform(random), 2 * uniform(random), uniform(random));
        }
        constexpr int kParts = 40;
        double step = 0;
        for (const Points* line : {&p, &q}) {
            for (std::size_t i = 0; i + 1 < line->size(); ++i) {
                step = std::max(step, ((*line)[i + 1] - (*line)[i]).norm() / kParts);
            }
        }
        const double exact = frechet_distance(p, q), above = discrete(refined(p, kParts), refined(q, kParts));
        EXPECT_LE(exact, above + 1e-3) << round;
        EXPECT_GE(exact, above - step - 1e-3) << round;
    }
}

}  // namespace frechet_test
}  // namespace seampath
