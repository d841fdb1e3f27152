#include "stages/geometry/views.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/geometry/clouds.hpp"

/// Views told from the order of the points.
namespace seampath {
namespace views_test {

using Eigen::Vector3d;
using testing::ElementsAre;

/// A view of a corner, row by row along x, from one place to another on either side.
void add_view(std::vector<Eigen::Vector3f>& points, double from, double to, std::uint64_t seed) {
    const Sampling sampling{0.4, 0.03, seed};
    for (double along = 0; along < std::abs(to - from); along += 0.4) {
        const double x = to > from ? from + along : from - along;
        add_rectangle(points, {x, 0, 0}, Vector3d::UnitX(), 0.4, Vector3d::UnitY(), 30, sampling);
        add_rectangle(points, {x, 0, 0}, Vector3d::UnitX(), 0.4, Vector3d::UnitZ(), 30, sampling);
    }
}

TEST(Views, BeginWherePointsComeBack) {
    std::vector<Eigen::Vector3f> points;
    std::vector<std::size_t> begin;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        begin.push_back(points.size());
        add_view(points, 0, seed == 3 ? 50 : 80, seed);
    }
    const auto starts = view_starts(points);
    ASSERT_EQ(starts.size(), begin.size());
    for (std::size_t i = 0; i < begin.size(); ++i) {
        EXPECT_NEAR(static_cast<double>(starts[i]), static_cast<double>(begin[i]), 1500) << i;  // ten rows
    }
}

// The second view sees 50 mm that are new before it comes to what the first one saw, and the third begins likewise.
TEST(Views, BeginWhereTheLookJumpsToPlacesNotSeenBefore) {
    std::vector<Eigen::Vector3f> points;
    add_view(points, 0, 60, 1);
    const std::size_t second = points.size();
    add_view(points, 110, 20, 2);
    const std::size_t third = points.size();
    add_view(points, 150, 60, 3);
    const auto starts = view_starts(points);
    ASSERT_EQ(starts.size(), 3u);
    EXPECT_NEAR(static_cast<double>(starts[1]), static_cast<double>(second), 600);  // four rows
    EXPECT_NEAR(static_cast<double>(starts[2]), static_cast<double>(third), 600);
}

// Rows of a view run along or across the corner; a tenth of the points is missing and some are strays.
std::vector<Eigen::Vector3f> coarse_views(int views, double spacing, double size, std::uint64_t seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    std::normal_distribution<double> noise(0, 0.4 * spacing);
    std::uniform_real_distribution<double> anywhere(0, 1);
    const int n = static_cast<int>(size / spacing);
    std::vector<Eigen::Vector3f> points;
    for (int view = 0; view < views; ++view) {
        const bool across = view % 2 == 1, from_end = view % 4 > 1;
        const auto place = [&](int i, int folded) {
            const double x = spacing * (from_end ? n - i : i), u = spacing * folded - size / 2;
            return u < 0 ? Vector3d(x, -u, noise(random)) : Vector3d(x, noise(random), u);
        };
        for (int row = 0; row < n; ++row) {
            for (int column = 0; column < n; ++column) {
                const Vector3d p = across ? place(column, row) : place(row, column);
                if (anywhere(random) < 0.9) {
                    const Vector3d stray(size * anywhere(random), size * anywhere(random), size * anywhere(random));
                    points.push_back((anywhere(random) < 0.01 ? stray : p).cast<float>());
                }
            }
        }
    }
    return points;
}

TEST(Views, AreToldInCoarseAndInSmallScans) {
    for (const double spacing : {1.1, 0.7, 0.4, 0.2}) {
        for (const int views : {1, 2, 3, 5}) {
            for (std::uint64_t seed = 1; seed <= 5; ++seed) {
                auto points = coarse_views(views, spacing, 30, seed);
                const auto starts = view_starts(points);
                ASSERT_EQ(starts.size(), static_cast<std::size_t>(views)) << spacing << " mm, seed " << seed;
                const double of_view = static_cast<double>(points.size()) / views, row = 0.9 * 30 / spacing;
                for (std::size_t i = 0; i < starts.size(); ++i) {
                    EXPECT_NEAR(static_cast<double>(starts[i]), static_cast<double>(i) * of_view, 4 * row + 60);
                }
                std::shuffle(points.begin(), points.end(), std::mt19937(1));
                EXPECT_THAT(view_starts(points), ElementsAre(0)) << spacing << " mm, seed " << seed;
            }
        }
    }
}

TEST(Views, AreNotTakenFromPointsInNoOrder) {
    std::vector<Eigen::Vector3f> points;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        add_view(points, 0, 80, seed);
    }
    EXPECT_EQ(view_starts(points).size(), 3u);
    std::shuffle(points.begin(), points.end(), std::mt19937(1));
    EXPECT_THAT(view_starts(points), ElementsAre(0));
}

TEST(Views, OneViewIsOne) {
    std::vector<Eigen::Vector3f> points;
    add_view(points, 0, 80, 1);
    EXPECT_THAT(view_starts(points), ElementsAre(0));
    EXPECT_THAT(view_starts({}), ElementsAre(0));
    EXPECT_THAT(view_starts(std::vector<Eigen::Vector3f>(5000, Eigen::Vector3f::Zero())).front(), 0u);
}

}  // namespace views_test
}  // namespace seampath
