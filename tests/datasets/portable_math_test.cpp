#include "datasets/portable_math.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "datasets/rng.hpp"

namespace seampath {
namespace portable_math_test {

TEST(PortableMath, AgreesWithTheLibraryToTheLastDigits) {
    const Random random(7, 0);
    for (std::uint64_t i = 0; i < 20000; ++i) {
        const double x = random.uniform(2 * i, -2000, 2000);
        const auto [s, c] = portable::sincos(x);
        ASSERT_NEAR(s, std::sin(x), 4e-16) << x;
        ASSERT_NEAR(c, std::cos(x), 4e-16) << x;
        ASSERT_NEAR(portable::atan(x), std::atan(x), 1e-15) << x;
        const double y = random.uniform(2 * i + 1);
        ASSERT_NEAR(portable::acos(2 * y - 1), std::acos(2 * y - 1), 4e-15) << y;
        ASSERT_NEAR(portable::log(y), std::log(y), 4e-16 * (1 + std::abs(std::log(y)))) << y;
        ASSERT_NEAR(portable::exp(-20 * y) / std::exp(-20 * y), 1, 1e-14) << y;
    }
}

TEST(PortableMath, HoldsAtQuarterTurns) {
    for (int quarter = -8; quarter <= 8; ++quarter) {
        const auto [s, c] = portable::sincos(quarter * portable::kPi / 2);
        EXPECT_NEAR(s * s + c * c, 1, 4e-16);
        EXPECT_NEAR(std::abs(s) + std::abs(c), 1, 2e-15);
    }
    EXPECT_EQ(portable::acos(1), 0);
    EXPECT_EQ(portable::exp(0), 1);
    EXPECT_EQ(portable::log(1), 0);
}

TEST(Random, NumberIsAFunctionOfSeedStreamAndIndex) {
    EXPECT_EQ(Random(1, 2).bits(3), Random(1, 2).bits(3));
    EXPECT_NE(Random(1, 2).bits(3), Random(2, 2).bits(3));
    EXPECT_NE(Random(1, 2).bits(3), Random(1, 3).bits(3));
    EXPECT_NE(Random(1, 2).bits(3), Random(1, 2).bits(4));
}

TEST(Random, NormalsHaveTheMomentsOfTheNormalDistribution) {
    const Random random(11, 4);
    const int n = 200000;
    double moment[5] = {};
    double lagged = 0;
    for (int i = 0; i < n; ++i) {
        const double x = random.normal(static_cast<std::uint64_t>(i));
        for (int k = 1; k <= 4; ++k) {
            moment[k] += std::pow(x, k) / n;
        }
        lagged += x * random.normal(static_cast<std::uint64_t>(i) + 1) / n;
    }
    // Four standard errors: sqrt(1, 2, 15, 96) / sqrt(n) for the powers.
    const double error = 4 / std::sqrt(n);
    EXPECT_NEAR(moment[1], 0, error);
    EXPECT_NEAR(moment[2], 1, error * std::sqrt(2));
    EXPECT_NEAR(moment[3], 0, error * std::sqrt(15));
    EXPECT_NEAR(moment[4], 3, error * std::sqrt(96));
    EXPECT_NEAR(lagged, 0, error);
}

}  // namespace portable_math_test
}  // namespace seampath
