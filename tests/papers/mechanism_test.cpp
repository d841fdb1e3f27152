#include "stages/mechanism/mechanism.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/error.hpp"

/// Naumov et al., its figures and what holds for the mechanism in general.
namespace seampath {
namespace mechanism_test {

using Eigen::Vector2d;
using testing::HasSubstr;

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180;
const std::vector<Vector2d> kPaperLine{{-350, -100}, {160, 280}};

TwoTierGrid grid_of(double alpha_deg, double beta_deg, double radius = 500) {
    return two_tier_grid(radius, alpha_deg * kDegree, beta_deg * kDegree);
}

TEST(Naumov, ForwardKinematicsIsEquation2) {
    const double R = 500;
    for (int a = 0; a < 360; a += 7) {
        for (int b = 0; b <= 60; b += 3) {
            const double alpha = a * kDegree, beta = b * kDegree;
            const Vector2d printed(R * std::sin(beta + alpha) - R * std::sin(alpha),
                                   R * std::cos(beta + alpha) - R * std::cos(alpha));
            EXPECT_LT((tool_position(R, {alpha, beta}) - printed).norm(), 1e-12 * R);
        }
    }
}

TEST(Naumov, InverseKinematicsInvertsOverTheDisc) {
    const double R = 500;
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int k = 0; k < 20000; ++k) {
        // Down to a billionth of the radius, and on the edge itself.
        const double out = k % 100 == 0 ? R : k % 3 == 0 ? R * std::pow(10, -9 * unit(random)) : R * unit(random);
        const double direction = 2 * kPi * unit(random);
        const Vector2d p = out * Vector2d(std::cos(direction), std::sin(direction));
        const TwoTierAngles angles = two_tier_angles(R, p);
        EXPECT_LT((tool_position(R, angles) - p).norm(), 2e-15 * R + 4e-16 * out);
        EXPECT_GE(angles.alpha, 0);
        EXPECT_LT(angles.alpha, 2 * kPi);
        EXPECT_GE(angles.beta, 0);
        EXPECT_LE(angles.beta, kPi / 3);
    }
    for (int k = 0; k < 20000; ++k) {
        const TwoTierAngles given{2 * kPi * unit(random), kPi / 3 * (0.001 + 0.998 * unit(random))};
        const TwoTierAngles found = two_tier_angles(R, tool_position(R, given));
        EXPECT_NEAR(std::remainder(found.alpha - given.alpha, 2 * kPi), 0, 1e-11);
        EXPECT_NEAR(found.beta, given.beta, 1e-14);
    }
}

TEST(Naumov, AtTheCentreAlphaIsFree) {
    const TwoTierAngles centre = two_tier_angles(500, {0, 0});
    EXPECT_EQ(centre.alpha, 0);
    EXPECT_EQ(centre.beta, 0);
    for (const double alpha : {0.0, 1.0, 5.0}) {
        EXPECT_EQ(tool_position(500, {alpha, 0}).norm(), 0);
    }
}

TEST(Naumov, PrintedFiguresAndTheSetsOfNodesTheyBelongTo) {
    const TwoTierGrid grid = grid_of(10, 5);
    const GridPath eight = follow(grid, kPaperLine, GridMethod::least_distance);
    EXPECT_EQ(eight.nodes.size(), 19u);
    EXPECT_NEAR(eight.interior.rms_mm, 9.914037, 5e-7);
    EXPECT_NEAR(eight.interior.max_mm, 24.69, 5e-3);
    const GridPath four = follow(grid, kPaperLine, GridMethod::bresenham);
    EXPECT_EQ(four.nodes.size(), 26u);
    EXPECT_NEAR(four.after_first.rms_mm, 15.799855, 5e-7);
    EXPECT_NEAR(four.interior.rms_mm, 16.0725, 5e-5);
    EXPECT_NEAR(four.all.rms_mm, 15.5053, 5e-5);
    EXPECT_NEAR(four.all.max_mm, 33.28, 5e-3);
    EXPECT_EQ(four.interior.nodes, 24u);
    EXPECT_EQ(four.after_first.nodes, 25u);
}

TEST(Naumov, ErrorAboutHalvesWithTheGrid) {
    struct Row {
        int divisor;
        double least_distance, bresenham;
    };
    for (const Row& row : {Row{2, 5.06, 7.76}, Row{4, 2.54, 4.21}, Row{8, 1.42, 2.09}, Row{16, 0.76, 1.08}}) {
        const TwoTierGrid grid = grid_of(10.0 / row.divisor, 5.0 / row.divisor);
        EXPECT_NEAR(follow(grid, kPaperLine, GridMethod::least_distance).interior.rms_mm, row.least_distance, 5.1e-3);
        EXPECT_NEAR(follow(grid, kPaperLine, GridMethod::bresenham).interior.rms_mm, row.bresenham, 5.1e-3);
    }
}

// Least sums of squares over the whole grid for each number of nodes, by recursion: no corridor, no Lagrange
// multiplier.
class BruteForce {
public:
    BruteForce(const TwoTierGrid& grid, const Vector2d& M1, const Vector2d& M2, bool single, GridNode goal)
        : grid_(grid), M1_(M1), M2_(M2), single_(single), goal_(goal) {}

    double least_rms(GridNode start) {
        double best = std::numeric_limits<double>::infinity();
        for (const auto& [interior, sum] : sums(start)) {
            best = std::min(best, std::sqrt(sum / interior));
        }
        return best;
    }

private:
    using Sums = std::map<int, double>;  // nodes between this one and the goal -> least sum of their squares

    const Sums& sums(GridNode node) {
        const auto key = std::pair(node.j == 0 ? 0 : node.i, node.j);
        if (const auto known = known_.find(key); known != known_.end()) {
            return known->second;
        }
        Sums result;
        for (int i = 0; i < grid_.alpha_steps; ++i) {
            for (int j = std::max(0, node.j - 1); j <= std::min(grid_.beta_steps, node.j + 1); ++j) {
                const GridNode next{i, j};
                if (!neighbours(node, next) || to_end(next) >= to_end(node) - 1e-9) {
                    continue;
                }
                if (next == goal_) {
                    result.emplace(0, 0);
                    continue;
                }
                for (const auto& [interior, sum] : sums(next)) {
                    const double total = sum + square(next);
                    const auto [entry, is_new] = result.emplace(interior + 1, total);
                    entry->second = std::min(entry->second, total);
                }
            }
        }
        return known_[key] = result;
    }
    bool neighbours(GridNode a, GridNode b) const {
        if (a.j == 0 || b.j == 0) {
            return a.j + b.j == 1;
        }
        const int di = std::abs(std::remainder(a.i - b.i, grid_.alpha_steps)), dj = std::abs(a.j - b.j);
        return di <= 1 && dj <= 1 && di + dj > 0 && (!single_ || di + dj == 1);
    }
    double to_end(GridNode node) const { return (position(grid_, node) - M2_).norm(); }
    double square(GridNode node) const {
        const Vector2d along = (M2_ - M1_).normalized(), w = position(grid_, node) - M1_;
        return (w - w.dot(along) * along).squaredNorm();
    }

    TwoTierGrid grid_;
    Vector2d M1_, M2_;
    bool single_;
    GridNode goal_;
    std::map<std::pair<int, int>, Sums> known_;
};

TEST(Mechanism, OptimumIsThatOfBruteForce) {
    const std::vector<std::vector<Vector2d>> lines{kPaperLine, {{-300, 200}, {350, -120}}, {{10, 480}, {-20, -450}}};
    for (const int divisor : {1, 2}) {
        const TwoTierGrid grid = grid_of(10.0 / divisor, 5.0 / divisor);
        for (const auto& line : lines) {
            for (const bool single : {false, true}) {
                const GridPath greedy = follow(grid, line, single ? GridMethod::bresenham : GridMethod::least_distance);
                const GridPath optimal = follow(grid, line, single ? GridMethod::optimal_single : GridMethod::optimal);
                BruteForce brute(grid, line[0], line[1], single, greedy.nodes.back().node);
                EXPECT_NEAR(optimal.interior.rms_mm, brute.least_rms(greedy.nodes.front().node), 1e-9);
                EXPECT_LE(optimal.interior.rms_mm, greedy.interior.rms_mm);
                EXPECT_EQ(optimal.nodes.back().node, greedy.nodes.back().node);
            }
        }
    }
}

TEST(Naumov, BothMethodsAreOptimalOnThePapersGridButNotOnAll) {
    EXPECT_NEAR(follow(grid_of(10, 5), kPaperLine, GridMethod::optimal).interior.rms_mm, 9.914037, 5e-7);
    EXPECT_NEAR(follow(grid_of(10, 5), kPaperLine, GridMethod::optimal_single).interior.rms_mm, 16.072478, 5e-7);
    const GridPath half = follow(grid_of(5, 2.5), kPaperLine, GridMethod::optimal);
    EXPECT_EQ(half.nodes.size(), 34u);
    EXPECT_NEAR(half.interior.rms_mm, 4.997, 5e-4);
}

TEST(Mechanism, NearestNodeIsThatOfBruteForce) {
    const TwoTierGrid grid = grid_of(15, 6, 80);
    std::mt19937_64 random(2);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int k = 0; k < 2000; ++k) {
        const double out = 80 * unit(random), direction = 2 * kPi * unit(random);
        const Vector2d p = out * Vector2d(std::cos(direction), std::sin(direction));
        double least = p.norm();
        for (int i = 0; i < grid.alpha_steps; ++i) {
            for (int j = 1; j <= grid.beta_steps; ++j) {
                least = std::min(least, (position(grid, {i, j}) - p).norm());
            }
        }
        EXPECT_NEAR((position(grid, nearest_node(grid, p)) - p).norm(), least, 1e-12);
    }
}

// Counted out from the first node, the beats lead to every node of the path and move no axis by more than one.
void expect_steps_replay(const TwoTierGrid& grid, const GridPath& path) {
    GridNode at = path.nodes.front().node;
    std::size_t reached = 1;
    for (const AxisStep& step : axis_steps(grid, path)) {
        ASSERT_LE(std::abs(step.alpha), 1);
        ASSERT_LE(std::abs(step.beta), 1);
        at = {(at.i + step.alpha + grid.alpha_steps) % grid.alpha_steps, at.j + step.beta};
        if (step.beta == 0 && at.j == 0) {
            continue;  // turns on the spot
        }
        ASSERT_LT(reached, path.nodes.size());
        ASSERT_LT((position(grid, at) - position(grid, path.nodes[reached].node)).norm(), 1e-9);
        ++reached;
    }
    EXPECT_EQ(reached, path.nodes.size());
}

TEST(Mechanism, StepsLeadAlongTheNodesAlsoThroughTheCentre) {
    for (const auto& line :
         {kPaperLine, std::vector<Vector2d>{{-400, 0}, {400, 0}}, std::vector<Vector2d>{{0, 0}, {123, -345}},
          std::vector<Vector2d>{{330, 20}, {0, 0}}, std::vector<Vector2d>{{-10, 499}, {3, -499}}}) {
        for (const GridMethod method :
             {GridMethod::least_distance, GridMethod::bresenham, GridMethod::optimal, GridMethod::optimal_single}) {
            const TwoTierGrid grid = grid_of(2, 1);
            const GridPath path = follow(grid, line, method);
            expect_steps_replay(grid, path);
            EXPECT_LT(path.end_gap_mm, 20);
            if (method == GridMethod::least_distance || method == GridMethod::optimal) {
                EXPECT_LT(path.all.max_mm, 9);  // half a cell of 17 mm by 9 to 17 mm
            }
        }
    }
}

// Outwards both axes must move at once to keep to a radius: one at a time, each move that goes nearer to M2 also leaves
// the line, on however fine a grid.
TEST(Mechanism, OneAxisAtATimeDoesNotConvergeOnLinesTowardsTheCentre) {
    const std::vector<Vector2d> line{{330, 20}, {0, 0}};
    for (const double step : {2.0, 0.2, 0.02}) {
        EXPECT_GT(follow(grid_of(step, step / 2), line, GridMethod::optimal_single).interior.max_mm, 25);
        EXPECT_LT(follow(grid_of(step, step / 2), line, GridMethod::least_distance).interior.max_mm, 3 * step);
    }
}

TEST(Mechanism, TurnsWithTheDisc) {
    const TwoTierGrid grid = grid_of(10, 5);
    for (const GridMethod method : {GridMethod::least_distance, GridMethod::bresenham}) {
        const GridPath given = follow(grid, kPaperLine, method);
        const Eigen::Rotation2Dd turn(-30 * kDegree);
        const GridPath turned = follow(grid, std::vector<Vector2d>{turn * kPaperLine[0], turn * kPaperLine[1]}, method);
        ASSERT_EQ(turned.nodes.size(), given.nodes.size());
        for (std::size_t k = 0; k < given.nodes.size(); ++k) {
            EXPECT_EQ(turned.nodes[k].node.i, (given.nodes[k].node.i + 3) % 36);
            EXPECT_EQ(turned.nodes[k].node.j, given.nodes[k].node.j);
        }
    }
}

TEST(Mechanism, FollowsAPolylineToTheGridsResolution) {
    std::vector<Vector2d> circle;
    for (int k = 0; k <= 720; ++k) {
        const double a = 2 * kPi * k / 720;
        circle.emplace_back(150 + 120 * std::cos(a), -40 + 120 * std::sin(a));
    }
    circle.insert(circle.begin() + 5, circle[4]);  // a point twice
    const TwoTierGrid grid = grid_of(0.2, 0.1);
    const GridPath path = follow(grid, circle, GridMethod::least_distance);
    double off = 0;
    for (const PathNode& node : path.nodes) {
        off = std::max(off, std::abs((position(grid, node.node) - Vector2d(150, -40)).norm() - 120));
    }
    EXPECT_LT(off, 1.5);  // a cell is 0.9 mm by up to 1.7 mm
    EXPECT_LT(path.end_gap_mm, 1.5);
    EXPECT_GT(path.nodes.size(), 500u);
    expect_steps_replay(grid, path);
}

TEST(Mechanism, OneMetreInHundredthsOfADegreeTakesLessThanASecond) {
    const std::vector<Vector2d> line{{-300, -400}, {290, 404}};
    const auto start = std::chrono::steady_clock::now();
    const GridPath path = follow(grid_of(0.01, 0.01), line, GridMethod::least_distance);
    EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 1);
    EXPECT_GT(path.nodes.size(), 8000u);
    EXPECT_LT(path.interior.rms_mm, 0.05);
}

template <class Act>
std::string refusal(const Act& act) {
    try {
        act();
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

TEST(Mechanism, RefusesWhatItCannotReachOrStep) {
    const TwoTierGrid grid = grid_of(10, 5);
    const std::vector<Vector2d> out{{0, 0}, {300, 400.01}}, none{{1, 2}, {1, 2}}, nan{{0, 0}, {0, std::nan("")}};
    EXPECT_THAT(refusal([&] { follow(grid, out, GridMethod::bresenham); }),
                testing::AllOf(HasSubstr("point 2 of the path, (300, 400.01) lies 500.008 mm from the centre"),
                               HasSubstr("the tool reaches 500 mm")));
    EXPECT_THAT(refusal([&] { follow(grid, none, GridMethod::bresenham); }), HasSubstr("has no length"));
    EXPECT_THAT(refusal([&] { follow(grid, nan, GridMethod::bresenham); }), HasSubstr("point 2"));
    EXPECT_THAT(refusal([] { two_tier_angles(500, {400, 400}); }), HasSubstr("from the centre"));
    EXPECT_THAT(refusal([] { grid_of(7, 5); }), HasSubstr("the step of alpha is 7"));
    EXPECT_THAT(refusal([] { grid_of(10, 7); }), HasSubstr("the step of beta is 7"));
    EXPECT_THAT(refusal([] { grid_of(-10, 5); }), HasSubstr("alpha"));
    EXPECT_THAT(refusal([] { grid_of(0, 5); }), HasSubstr("alpha"));
    EXPECT_THAT(refusal([] { grid_of(10, 5, -1); }), HasSubstr("the radius is -1 mm"));
    EXPECT_EQ(refusal([&] {
                  follow(grid, std::vector<Vector2d>{{500, 0}, {-300, -400}}, GridMethod::optimal);
              }),
              "accepted");
}

}  // namespace mechanism_test
}  // namespace seampath
