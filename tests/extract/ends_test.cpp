#include <gtest/gtest.h>

#include "tests/extract/support.hpp"

/// Where open seams end: where the first of the two flanks does.
namespace seampath {
namespace ends_test {

using Eigen::Vector3d;

/// A corner along the x axis from 0 to 80 mm whose floor many views saw, and one view the wall.
std::vector<Eigen::Vector3f> floor_and_sparse_wall() {
    std::vector<Eigen::Vector3f> points;
    add_rectangle(points, {0, 0, 0}, Vector3d::UnitX(), 80, Vector3d::UnitY(), 30, {0.22, 0.045, 1});
    add_rectangle(points, {0, 0, 0}, Vector3d::UnitX(), 80, Vector3d::UnitZ(), 30, {0.7, 0.045, 2});
    return points;
}

void expect_ends(std::vector<Eigen::Vector3f> points, double low, double high) {
    const Extraction extraction = extract(scan_of_points(std::move(points)), {});
    ASSERT_EQ(extraction.seams.size(), 1u);
    const auto& seam = extraction.seams.front().points;
    EXPECT_NEAR(std::min(seam.front().p.x(), seam.back().p.x()), low, 1.5);
    EXPECT_NEAR(std::max(seam.front().p.x(), seam.back().p.x()), high, 1.5);
    for (const SeamPoint& point : seam) {
        EXPECT_LT(point.p.tail<2>().norm(), 0.12) << point.p.transpose();
    }
}

TEST(Ends, OfASparseFlankAreNotTakenForEarlier) {
    expect_ends(floor_and_sparse_wall(), 0, 80);
}

TEST(Ends, AHoleBeforeTheEndIsNoEnd) {
    auto points = floor_and_sparse_wall();
    std::erase_if(
        points, [](const Eigen::Vector3f& p) { return p.z() > 0.3f && (p - Eigen::Vector3f(77, 0, 5)).norm() < 2.5f; });
    expect_ends(points, 0, 80);
}

TEST(Ends, AreWhereTheShorterFlankEnds) {
    auto points = floor_and_sparse_wall();
    std::erase_if(points, [](const Eigen::Vector3f& p) { return p.z() > 0.3f && (p.x() < 11 || p.x() > 62); });
    expect_ends(points, 11, 62);
}

TEST(Ends, OfASlantedFlankAreWhereItMeetsTheSeam) {
    auto points = floor_and_sparse_wall();
    std::erase_if(points, [](const Eigen::Vector3f& p) { return p.z() > 0.3f && p.x() > 60 + 0.5f * p.z(); });
    expect_ends(points, 0, 60);
}

}  // namespace ends_test
}  // namespace seampath
