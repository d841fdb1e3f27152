#include "stages/geometry/path_moves.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "stages/geometry/pose.hpp"

namespace seampath {
namespace path_moves_test {

constexpr double kPi = std::numbers::pi;

TEST(Arc, KnownCircle) {
    const auto arc = arc_through({5, 0, 1}, {0, 5, 1}, {-5, 0, 1});
    ASSERT_TRUE(arc);
    EXPECT_LT((arc->centre - Eigen::Vector3d(0, 0, 1)).norm(), 1e-14);
    EXPECT_NEAR(arc->radius, 5, 1e-14);
    EXPECT_NEAR(arc->angle, kPi, 1e-14);
    EXPECT_LT((arc->at(0.5) - Eigen::Vector3d(0, 5, 1)).norm(), 1e-14);
    const auto long_way = arc_through({5, 0, 1}, {-5, 0, 1}, {0, 5, 1});
    EXPECT_NEAR(long_way->angle, 1.5 * kPi, 1e-14) << "through the point on the way, not the short way";
    EXPECT_LT((long_way->at(1) - Eigen::Vector3d(0, 5, 1)).norm(), 1e-14);
    EXPECT_FALSE(arc_through({0, 0, 0}, {1, 1, 1}, {3, 3, 3}));
    EXPECT_FALSE(arc_through({0, 0, 0}, {0, 0, 0}, {3, 3, 3}));
    EXPECT_FALSE(arc_through({0, 0, 0}, {1, 0, 0}, {0, 0, 0}));
}

TEST(Arc, NearestIsThatOfBruteForce) {
    std::mt19937_64 generator(5);
    std::normal_distribution<double> normal;
    const auto point = [&] { return Eigen::Vector3d(normal(generator), normal(generator), normal(generator)); };
    for (int i = 0; i < 300; ++i) {
        const Eigen::Vector3d a = point(), b = point(), c = point(), p = 2 * point();
        const auto arc = arc_through(a, b, c);
        ASSERT_TRUE(arc);
        EXPECT_LT((arc->at(0) - a).norm() + (arc->at(1) - c).norm(), 1e-12 * arc->radius);
        EXPECT_LT(nearest_on_arc(b, *arc).distance_mm, 1e-12 * arc->radius);
        double least = std::numeric_limits<double>::infinity(), least_straight = least;
        for (int k = 0; k <= 4000; ++k) {
            least = std::min(least, (arc->at(k / 4000.0) - p).norm());
            least_straight = std::min(least_straight, (a + k / 4000.0 * (c - a) - p).norm());
        }
        const double step = arc->radius * arc->angle / 4000;
        const NearestOnPath found = nearest_on_arc(p, *arc);
        EXPECT_NEAR(found.distance_mm, least, step);
        EXPECT_LE(found.distance_mm, least + 1e-12);
        EXPECT_NEAR((arc->at(found.fraction) - p).norm(), found.distance_mm, 1e-12);
        EXPECT_NEAR(nearest_on_segment(p, a, c).distance_mm, least_straight, 2e-3);
    }
}

TEST(Euler, GoesBackEverywhere) {
    std::mt19937_64 generator(9);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 4000; ++i) {
        // The second half comes ever nearer to y = +-90 deg.
        const double off = i < 2000 ? kPi * normal(generator) : std::pow(10, -(i - 2000) / 120.0);
        const double y = i < 2000 ? off : (i % 2 ? 1 : -1) * (kPi / 2 - off);
        const Eigen::Quaterniond q = from_euler_zyx(normal(generator), y, normal(generator));
        const Eigen::Vector3d zyx = euler_zyx(q);
        EXPECT_LT(rotation_angle(q, from_euler_zyx(zyx[0], zyx[1], zyx[2])), 3e-8) << i;
        EXPECT_LE(std::abs(zyx[1]), kPi / 2 + 1e-15);
        EXPECT_LE(std::max(std::abs(zyx[0]), std::abs(zyx[2])), kPi);
    }
    EXPECT_EQ(euler_zyx(Eigen::Quaterniond::Identity()), Eigen::Vector3d::Zero());
    const Eigen::Vector3d free = euler_zyx(from_euler_zyx(0.3, kPi / 2, 0.1), 0.7);
    EXPECT_NEAR(free[0], 0.7, 1e-12) << "z is free";
    EXPECT_NEAR(free[2], 0.5, 1e-7) << "z - x is not";
}

std::vector<PathPose> poses_of(const std::vector<Eigen::Vector3d>& points) {
    std::vector<PathPose> poses;
    for (const Eigen::Vector3d& p : points) {
        poses.push_back({p, Eigen::Quaterniond::Identity()});
    }
    return poses;
}

std::vector<PathPose> circle(double radius, double turn, int count) {
    std::vector<Eigen::Vector3d> points;
    for (int k = 0; k < count; ++k) {
        const double t = turn * k / (count - 1);
        points.emplace_back(radius * std::cos(t), radius * std::sin(t), 0);
    }
    return poses_of(points);
}

constexpr MoveTolerance kFine{0.01, 0.01};

TEST(FewestMoves, OneForALineAndForAnArc) {
    std::vector<Eigen::Vector3d> line;
    for (int k = 0; k < 50; ++k) {
        line.emplace_back(k, 2 * k, -k);
    }
    const auto straight = fewest_moves(poses_of(line), kFine);
    ASSERT_EQ(straight.size(), 1u);
    EXPECT_EQ(straight[0].end, 49u);
    EXPECT_FALSE(straight[0].via);
    const auto bent = fewest_moves(circle(40, 2, 50), kFine);
    ASSERT_EQ(bent.size(), 1u);
    EXPECT_TRUE(bent[0].via);
    EXPECT_NEAR(static_cast<double>(*bent[0].via), 24.5, 0.6) << "half way";
    EXPECT_EQ(fewest_moves(circle(40, 2 * kPi, 100), kFine).size(), 3u) << "a full circle, 175 deg each at most";
    EXPECT_TRUE(fewest_moves(poses_of({{1, 2, 3}}), kFine).empty());
    EXPECT_EQ(fewest_moves(poses_of({{1, 2, 3}, {1, 2, 3}}), kFine).size(), 1u);
}

TEST(FewestMoves, LineThenArcThenLine) {
    std::vector<Eigen::Vector3d> points;
    for (int k = 0; k < 20; ++k) {
        points.emplace_back(k - 20, -10, 0);
    }
    for (int k = 0; k <= 30; ++k) {
        const double t = kPi / 2 * k / 30;
        points.emplace_back(10 * std::sin(t), -10 * std::cos(t), 0);
    }
    for (int k = 1; k < 20; ++k) {
        points.emplace_back(10, k, 0);
    }
    const auto moves = fewest_moves(poses_of(points), kFine);
    ASSERT_EQ(moves.size(), 3u);
    EXPECT_TRUE(!moves[0].via && moves[1].via && !moves[2].via);
}

TEST(FewestMoves, KeepOrientationsToo) {
    auto poses = circle(40, 1, 41);
    for (std::size_t k = 0; k < poses.size(); ++k) {
        const double t = static_cast<double>(k) / 40;
        poses[k].q = Eigen::AngleAxisd(0.2 * t * t, Eigen::Vector3d::UnitX());  // 0.05 from an even turn half way
    }
    EXPECT_EQ(fewest_moves(poses, {0.01, 0.051}).size(), 1u);
    EXPECT_GT(fewest_moves(poses, {0.01, 0.049}).size(), 1u);
}

TEST(FewestMoves, SeeWhatTheCurveDoesBetweenFarPoints) {
    // Corners of a square lie on one circle, but nothing says that the way between them does.
    const auto poses = poses_of({{10, 0, 0}, {0, 10, 0}, {-10, 0, 0}, {0, -10, 0}, {10, 0, 0}});
    const auto moves = fewest_moves(poses, kFine);
    EXPECT_EQ(moves.size(), 4u);
}

// Fewest by trying every chain of ends, with the errors as move_error() has them.
std::size_t by_trial(const std::vector<PathPose>& poses, const MoveTolerance& tolerance) {
    const std::size_t n = poses.size();
    std::size_t fewest = n;
    for (std::size_t mask = 0; mask < (std::size_t{1} << (n - 2)); ++mask) {
        std::vector<std::size_t> ends{0};
        for (std::size_t k = 1; k + 1 < n; ++k) {
            if (mask >> (k - 1) & 1) {
                ends.push_back(k);
            }
        }
        ends.push_back(n - 1);
        bool all = true;
        for (std::size_t i = 1; i < ends.size() && all; ++i) {
            // A sub-path of its own is one move, or it is not: one end at a time decides.
            const std::span<const PathPose> part(&poses[ends[i - 1]], ends[i] - ends[i - 1] + 1);
            bool one = part.size() == 2;
            for (std::size_t via = 0; !one && via + 1 < part.size(); ++via) {
                const PathMove move{part.size() - 1, via == 0 ? std::optional<std::size_t>() : via};
                const MoveError error = move_error(part, 0, move);
                one = error.distance_mm <= tolerance.distance_mm && error.angle_rad <= tolerance.angle_rad;
            }
            all = one;
        }
        fewest = all ? std::min(fewest, ends.size() - 1) : fewest;
    }
    return fewest;
}

TEST(FewestMoves, AreAsFewAsTrialFinds) {
    std::mt19937_64 generator(3);
    std::uniform_real_distribution<double> uniform(-1, 1);
    int more = 0;
    for (int i = 0; i < 60; ++i) {
        // A smooth way of 11 points: a parabola and a wave, of random sizes.
        const double a = uniform(generator), b = uniform(generator), c = 2 * uniform(generator);
        std::vector<Eigen::Vector3d> points;
        for (int k = 0; k < 11; ++k) {
            const double x = 0.5 * k;
            points.emplace_back(x, 0.3 * a * x * x, b * std::sin(c * x));
        }
        const auto poses = poses_of(points);
        const MoveTolerance tolerance{0.05, 0.01};
        const auto moves = fewest_moves(poses, tolerance);
        std::size_t from = 0;
        for (const PathMove& move : moves) {
            const MoveError error = move_error(poses, from, move);
            EXPECT_LE(error.distance_mm, tolerance.distance_mm);
            from = move.end;
        }
        EXPECT_EQ(from, 10u);
        // Trial knows neither the curve between the points nor the limits of arcs: it may do with fewer.
        const std::size_t trial = by_trial(poses, tolerance);
        EXPECT_GE(moves.size(), trial) << i;
        more += moves.size() > trial + 1 ? 1 : 0;
    }
    EXPECT_LE(more, 3);
}

}  // namespace path_moves_test
}  // namespace seampath
