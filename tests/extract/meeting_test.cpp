#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/extract/support.hpp"

/// Joints that meet: where three surfaces come together, seams end.
namespace seampath {
namespace meeting_test {

using Eigen::Vector3d;

/// The seam whose middle is nearest to p.
const Seam& seam_at(const std::vector<Seam>& seams, const Vector3d& p) {
    return *std::min_element(seams.begin(), seams.end(), [&](const Seam& a, const Seam& b) {
        const auto middle = [&](const Seam& s) { return (s.points[s.points.size() / 2].p - p).norm(); };
        return middle(a) < middle(b);
    });
}

/// Ends on the axis at 0 and at `length`, and all of it on the axis.
void expect_on_axis(const Seam& seam, int axis, double length) {
    EXPECT_FALSE(seam.closed);
    double low = 1e9, high = -1e9;
    for (const SeamPoint& point : seam.points) {
        low = std::min(low, point.p[axis]);
        high = std::max(high, point.p[axis]);
        Vector3d across = point.p;
        across[axis] = 0;
        EXPECT_LT(across.norm(), 0.12) << point.p.transpose();
    }
    EXPECT_NEAR(low, 0, 1.5);
    EXPECT_NEAR(high, length, 1.5);
}

TEST(Meeting, ThreePlanesGiveThreeSeamsThatEndInTheirCorner) {
    std::vector<Eigen::Vector3f> points;
    const Sampling sampling{0.25, 0.045, 3};
    add_rectangle(points, {0, 0, 0}, Vector3d::UnitX(), 80, Vector3d::UnitY(), 60, sampling);
    add_rectangle(points, {0, 0, 0}, Vector3d::UnitX(), 80, Vector3d::UnitZ(), 45, sampling);
    add_rectangle(points, {0, 0, 0}, Vector3d::UnitY(), 60, Vector3d::UnitZ(), 45, sampling);
    const Extraction extraction = extract(scan_of_points(std::move(points)), {});
    ASSERT_EQ(extraction.seams.size(), 3u);
    expect_on_axis(seam_at(extraction.seams, {40, 0, 0}), 0, 80);
    expect_on_axis(seam_at(extraction.seams, {0, 30, 0}), 1, 60);
    expect_on_axis(seam_at(extraction.seams, {0, 0, 22}), 2, 45);
}

TEST(Meeting, AStiffenerAcrossAJointEndsItOnBothSides) {
    // A wall along x, and in the middle of it a rib square to it, 6 mm thick: its four seams on this side of the wall.
    std::vector<Eigen::Vector3f> points;
    const Sampling sampling{0.25, 0.045, 4};
    for (const double side : {-1.0, 1.0}) {
        const Vector3d x = side * Vector3d::UnitX();
        add_rectangle(points, 3 * x, x, 60, Vector3d::UnitY(), 50, sampling);
        add_rectangle(points, 3 * x, x, 60, Vector3d::UnitZ(), 50, sampling);
        add_rectangle(points, 3 * x, Vector3d::UnitY(), 50, Vector3d::UnitZ(), 50, sampling);
    }
    add_rectangle(points, {-3, 50, 0}, Vector3d::UnitX(), 6, Vector3d::UnitZ(), 50, sampling);
    add_rectangle(points, {-3, 0, 50}, Vector3d::UnitX(), 6, Vector3d::UnitY(), 50, sampling);
    const Extraction extraction = extract(scan_of_points(std::move(points)), {});
    ASSERT_EQ(extraction.seams.size(), 6u);
    for (const Seam& seam : extraction.seams) {
        const double length = length_of(seam);
        EXPECT_THAT(length, testing::AnyOf(testing::DoubleNear(60, 3), testing::DoubleNear(50, 3)));
        for (const SeamPoint& point : seam.points) {
            // On two of the three planes.
            std::array<double, 3> off{std::abs(std::abs(point.p.x()) - 3), std::abs(point.p.y()),
                                      std::abs(point.p.z())};
            std::sort(off.begin(), off.end());
            EXPECT_LT(std::hypot(off[0], off[1]), 0.12) << point.p.transpose();
        }
    }
}

}  // namespace meeting_test
}  // namespace seampath
