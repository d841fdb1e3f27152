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
