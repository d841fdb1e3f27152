#include "stages/extract/equal_steps.hpp"

#include <Eigen/Core>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace seampath::detail {
namespace equal_steps_test {

using Eigen::Vector2d;

std::vector<Vector2d> stepped(const std::vector<Vector2d>& way, bool closed, double step) {
    return equal_steps(
        way, closed, step, [](const Vector2d& p) -> const Vector2d& { return p; },
        [](const Vector2d& a, const Vector2d& b, double x) -> Vector2d { return (1 - x) * a + x * b; });
}

TEST(EqualSteps, KeepBothEndsOfAnOpenWay) {
    const std::vector<Vector2d> places = stepped({{0, 0}, {1, 0}, {1, 9}}, false, 0.9);
    ASSERT_EQ(places.size(), 12u);
    EXPECT_EQ(places.front(), Vector2d(0, 0));
    EXPECT_EQ(places.back(), Vector2d(1, 9));
    EXPECT_NEAR((places[7] - places[6]).norm(), 10.0 / 11, 1e-12);
}

TEST(EqualSteps, GoRoundAClosedWayOnce) {
    const std::vector<Vector2d> places = stepped({{0, 0}, {2, 0}, {2, 2}, {0, 2}}, true, 1);
    ASSERT_EQ(places.size(), 8u);
    EXPECT_NEAR((places.back() - Vector2d(0, 1)).norm(), 0, 1e-12);
}

TEST(EqualSteps, HaveNothingToDoForOnePlace) {
    EXPECT_THAT(stepped({{3, 4}}, false, 1), testing::ElementsAre(Vector2d(3, 4)));
    EXPECT_THAT(stepped({{3, 4}}, true, 1), testing::ElementsAre(Vector2d(3, 4)));
    EXPECT_THAT(stepped({}, true, 1), testing::IsEmpty());
}

// Two places in one point: no step, no division by it.
TEST(EqualSteps, StayFiniteWithoutLength) {
    for (const Vector2d& p : stepped({{1, 1}, {1, 1}}, false, 1)) {
        EXPECT_EQ(p, Vector2d(1, 1));
    }
}

}  // namespace equal_steps_test
}  // namespace seampath::detail
