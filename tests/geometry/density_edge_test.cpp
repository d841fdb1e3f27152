#include "stages/geometry/density_edge.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

/// The end of a surface's points, where their number is a Poisson process about a known end.
namespace seampath {
namespace density_edge_test {

struct Surface {
    double end = 10, blur = 0.04, density = 120;  // mm, mm, points per mm
    double beyond = 0;                            // density after the end over that before it
};

/// Points of a surface from 0 to its end, and of what lies beyond to 3 mm further.
std::vector<double> sample(const Surface& s, std::mt19937& random) {
    std::uniform_real_distribution<double> along(0, s.end + 3), share(0, 1);
    std::poisson_distribution<int> number(s.density * (s.end + 3));
    std::vector<double> x;
    for (int n = number(random); n > 0; --n) {
        const double at = along(random), there = 0.5 * std::erfc((at - s.end) / (std::sqrt(2.0) * s.blur));
        if (share(random) < there + s.beyond * (1 - there)) {
            x.push_back(at);
        }
    }
    return x;
}

class DensityEdgeOf : public testing::TestWithParam<Surface> {};
INSTANTIATE_TEST_SUITE_P(Surfaces, DensityEdgeOf,
                         testing::Values(Surface{}, Surface{10, 0.04, 400}, Surface{10, 0.04, 40},
                                         Surface{10, 0.08, 120}, Surface{10, 0.04, 120, 0.02},
                                         Surface{10, 0.04, 120, 0.1}, Surface{10, 0.04, 400, 0.15}));

TEST_P(DensityEdgeOf, IsWhereItsSigmaSays) {
    const Surface surface = GetParam();
    std::mt19937 random(7);
    constexpr int kDraws = 200;
    // A chance gap in few points passes for an end, and a few beyond it for its going on, now and then.
    int missed = 0;
    double sum = 0, squares = 0;
    for (int i = 0; i < kDraws; ++i) {
        const auto edge = density_edge(sample(surface, random), 5, 0.06, 0.04);
        if (!edge || std::abs(edge->at - surface.end) > 0.4) {
            ++missed;
            continue;
        }
        const double off = (edge->at - surface.end) / edge->sigma;
        sum += off;
        squares += off * off;
    }
    EXPECT_LE(missed, 0.03 * kDraws);
    EXPECT_LT(std::abs(sum / kDraws), 0.5);
    // Scanners sample in rows, so that the sigma is for twice the variance of independent points.
    const double rms = std::sqrt(squares / (kDraws - missed));
    EXPECT_LT(rms, 0.9);
    EXPECT_GT(rms, 0.35);
}

TEST(DensityEdge, IsNotTheLastPoint) {
    std::mt19937 random(3);
    std::vector<double> x = sample({}, random);
    x.insert(x.end(), {10.9, 11.7, 12.4});
    EXPECT_NEAR(density_edge(x, 5, 0.06, 0.04)->at, 10, 0.06);
}

// ... which lies beyond a gap that is too short for all the bins that tell an end.
TEST(DensityEdge, IsNotThatOfADenserFaceSoonBeyondIt) {
    std::mt19937 random(5);
    constexpr int kDraws = 200;
    int missed = 0;
    for (int draw = 0; draw < kDraws; ++draw) {
        std::vector<double> x = sample({10, 0.04, 80}, random);
        std::uniform_real_distribution<double> face(10.45, 11);
        for (int i = 0; i < 150; ++i) {
            x.push_back(face(random));
        }
        const auto edge = density_edge(x, 5, 0.06, 0.04);
        missed += !edge || std::abs(edge->at - 10) > 4 * edge->sigma;
    }
    EXPECT_LE(missed, 0.03 * kDraws);
}

TEST(DensityEdge, NeedsPointsBeforeIt) {
    EXPECT_FALSE(density_edge({}, 5, 0.06, 0.04));
    EXPECT_FALSE(density_edge({4.9, 4.95, 5.01, 5.02}, 5, 0.06, 0.04));
}

}  // namespace density_edge_test
}  // namespace seampath
