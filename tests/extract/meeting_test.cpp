#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/extract/support.hpp"
#include "tests/geometry/boxes.hpp"

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

TEST(Meeting, FilletsThatGoOnRoundCornersAreOneSeam) {
    SharpBox box = tilted_box();
    for (const std::uint64_t seed : {1, 2, 3}) {
        box.length = 60 + 25.0 * static_cast<double>(seed);
        const Extraction extraction = extract(box.scan(0.045, seed), {});
        ASSERT_EQ(extraction.seams.size(), 1u) << seed;
        const Seam& seam = extraction.seams.front();
        EXPECT_TRUE(seam.closed);
        ASSERT_EQ(seam.corners.size(), 4u);
        EXPECT_EQ(seam.corners.front(), 0u);
        for (const Vector3d& corner : box.corners()) {
            double nearest = 1e9;
            for (const std::size_t k : seam.corners) {
                nearest = std::min(nearest, (seam.points[k].p - corner).norm());
            }
            EXPECT_LT(nearest, 0.06) << seed;
        }
        const std::size_t n = seam.points.size();
        for (std::size_t i = 0; i < n; ++i) {
            const SeamPoint &at = seam.points[i], &next = seam.points[(i + 1) % n];
            EXPECT_LT(box.distance(at.p), 0.1);
            EXPECT_GT((next.p - at.p).dot(at.n1.cross(at.n2)), 0) << i;
            EXPECT_LT((next.p - at.p).norm(), 3) << i;
        }
    }
}

TEST(Meeting, FilletsRoundCornersStayApartWhenAskedFor) {
    ExtractOptions options;
    options.join_at_corners = false;
    const Extraction extraction = extract(tilted_box().scan(0.045, 1), options);
    EXPECT_EQ(extraction.seams.size(), 4u);
    for (const Seam& seam : extraction.seams) {
        EXPECT_FALSE(seam.closed);
        EXPECT_TRUE(seam.corners.empty());
    }
}

TEST(Meeting, TwoSidesRoundOneCornerAreAnOpenSeam) {
    // The far half of the box is out of sight.
    const SharpBox box = tilted_box();
    Scan scan = box.scan(0.045, 4);
    std::erase_if(scan.points, [&](const Eigen::Vector3f& p) {
        const Vector3d q = box.pose.inverse() * p.cast<double>();
        return q.x() / box.length + q.y() / box.width > 1;
    });
    const Extraction extraction = extract(scan, {});
    ASSERT_EQ(extraction.seams.size(), 1u);
    const Seam& seam = extraction.seams.front();
    EXPECT_FALSE(seam.closed);
    ASSERT_EQ(seam.corners.size(), 1u);
    EXPECT_LT((seam.points[seam.corners[0]].p - box.corners()[0]).norm(), 0.06);
    EXPECT_NEAR(length_of(seam), box.length + box.width, 4);
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
