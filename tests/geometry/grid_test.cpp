#include "stages/geometry/grid.hpp"

#include <algorithm>
#include <array>
#include <set>

#include <gtest/gtest.h>

#include "datasets/rng.hpp"

namespace seampath {
namespace grid_test {

std::vector<Eigen::Vector3f> random_points(std::size_t count, double extent) {
    const Random random(5, 0);
    std::vector<Eigen::Vector3f> points;
    for (std::uint64_t i = 0; i < count; ++i) {
        points.push_back(
            (extent * Eigen::Vector3d(random.uniform(3 * i), random.uniform(3 * i + 1), random.uniform(3 * i + 2)))
                .cast<float>());
    }
    return points;
}

std::multiset<double> in_ball(const PointGrid& grid, const Eigen::Vector3d& p, double radius) {
    std::multiset<double> distances;
    grid.for_points_in_ball(p, radius, [&](const Eigen::Vector3f& q, double d2) {
        EXPECT_DOUBLE_EQ(d2, (q.cast<double>() - p).squaredNorm());
        distances.insert(d2);
    });
    return distances;
}

TEST(PointGrid, BallHoldsWhatBruteForceFinds) {
    const auto points = random_points(5000, 20);
    for (const double cell : {0.3, 2.0, 50.0}) {
        const PointGrid grid(points, cell);
        const Random random(6, 0);
        for (std::uint64_t i = 0; i < 100; ++i) {
            const Eigen::Vector3d p(random.uniform(4 * i, -3, 23), random.uniform(4 * i + 1, -3, 23),
                                    random.uniform(4 * i + 2, -3, 23));
            const double radius = random.uniform(4 * i + 3, 0, 6);
            std::multiset<double> brute;
            for (const auto& q : points) {
                const double d2 = (q.cast<double>() - p).squaredNorm();
                if (d2 <= radius * radius) {
                    brute.insert(d2);
                }
            }
            EXPECT_EQ(in_ball(grid, p, radius), brute) << "cell " << cell << ", place " << i;
        }
    }
}

TEST(PointGrid, HoldsEachKeptPointOnce) {
    const auto points = random_points(1000, 20);
    std::vector<std::uint8_t> keep(points.size());
    for (std::size_t i = 0; i < keep.size(); ++i) {
        keep[i] = i % 3 == 0;
    }
    const PointGrid grid(points, 1.5, keep);
    std::set<std::uint32_t> sources;
    for (std::size_t k = 0; k < grid.size(); ++k) {
        EXPECT_EQ(grid.all()[k], points[grid.source(k)]);
        EXPECT_TRUE(keep[grid.source(k)]);
        sources.insert(grid.source(k));
    }
    EXPECT_EQ(sources.size(), 334u);
    EXPECT_EQ(grid.size(), 334u);
}

TEST(PointGrid, CellsFollowSpaceWhateverTheOrderOfThePoints) {
    const auto points = random_points(2000, 20);
    const std::vector<Eigen::Vector3f> reversed(points.rbegin(), points.rend());
    const PointGrid a(points, 2), b(reversed, 2);
    ASSERT_EQ(a.cells(), b.cells());
    for (std::size_t c = 0; c < a.cells(); ++c) {
        EXPECT_EQ(a.points(c).size(), b.points(c).size());
        EXPECT_LT((a.mean(c) - b.mean(c)).norm(), 1e-12);
    }
}

// Enough points for chunks, buckets and several digits of a key; two clusters leave most buckets empty.
TEST(PointGrid, ManyPointsAreSortedAsByTheStandardLibrary) {
    auto points = random_points(150000, 20);
    for (std::size_t i = 0; i < points.size(); i += 2) {
        points[i] += Eigen::Vector3f(500, 700, 900);
    }
    constexpr double kCell = 0.7;
    const PointGrid grid(points, kCell);
    Eigen::Vector3f low = points.front();
    for (const auto& p : points) {
        low = low.cwiseMin(p);
    }
    std::vector<std::array<std::int64_t, 4>> expected;  // z, y, x of the cell, index
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector3d at = (points[i].cast<double>() - low.cast<double>()) / kCell;
        expected.push_back({static_cast<std::int64_t>(at.z()), static_cast<std::int64_t>(at.y()),
                            static_cast<std::int64_t>(at.x()), static_cast<std::int64_t>(i)});
    }
    std::sort(expected.begin(), expected.end());
    ASSERT_EQ(grid.size(), points.size());
    std::size_t cell = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
        ASSERT_EQ(grid.source(k), expected[k][3]) << k;
        ASSERT_EQ(grid.all()[k], points[grid.source(k)]);
        const bool begins =
            k == 0 || !std::equal(expected[k].begin(), expected[k].begin() + 3, expected[k - 1].begin());
        if (begins) {
            ASSERT_EQ(grid.first_point(cell++), k);
        }
    }
    EXPECT_EQ(grid.cells(), cell);
}

TEST(PointGrid, BoxOfCellsHoldsThePointsOfTheBox) {
    const auto points = random_points(3000, 20);
    const PointGrid grid(points, 1.1);
    const Eigen::Vector3d low(3, 4, 5), high(9, 6, 17);
    std::size_t inside = 0;
    const auto is_inside = [&](const Eigen::Vector3f& q) {
        const Eigen::Vector3d p = q.cast<double>();
        return (p.array() >= low.array()).all() && (p.array() <= high.array()).all();
    };
    grid.for_cells_in_box(low, high, [&](std::size_t cell) {
        inside +=
            static_cast<std::size_t>(std::count_if(grid.points(cell).begin(), grid.points(cell).end(), is_inside));
    });
    EXPECT_EQ(inside, static_cast<std::size_t>(std::count_if(points.begin(), points.end(), is_inside)));
}

TEST(PointGrid, StraysFarAwayNeitherOverflowNorHideTheirNeighbours) {
    auto points = random_points(500, 20);
    points.emplace_back(1e12f, -1e12f, 1e12f);
    const PointGrid grid(points, 0.01);
    EXPECT_EQ(in_ball(grid, {10, 10, 10}, 100).size(), 500u);
    EXPECT_EQ(grid.size(), 501u);
}

TEST(PointGrid, OfNoPointsFindsNothing) {
    const PointGrid grid(std::vector<Eigen::Vector3f>{}, 1);
    EXPECT_EQ(grid.cells(), 0u);
    EXPECT_TRUE(in_ball(grid, {0, 0, 0}, 10).empty());
}

}  // namespace grid_test
}  // namespace seampath
