#include <gtest/gtest.h>

#include "stages/geometry/scale.hpp"
#include "tests/extract/support.hpp"

/// Extraction of scans in another order, of several parts, and with a wild point.
namespace seampath {
namespace order_test {

Scan shuffled(Scan scan) {
    const Random random(31, 0);
    for (std::size_t i = scan.points.size() - 1; i > 0; --i) {
        std::swap(scan.points[i], scan.points[random.bits(i) % (i + 1)]);
    }
    return scan;
}

TEST(ExtractLaws, ScaleDoesNotHangOnTheOrderOfThePoints) {
    const Scan scan = corner_scan();
    const ScanScale one = estimate_scale(scan.points).overall, other = estimate_scale(shuffled(scan).points).overall;
    EXPECT_NEAR(one.spacing, other.spacing, 1e-9);
    EXPECT_NEAR(one.noise, other.noise, 1e-9);
    EXPECT_NEAR(one.correlation, other.correlation, 1e-6);
}

TEST(ExtractLaws, OrderOfThePointsDoesNotMatter) {
    const Scan scan = corner_scan();
    const Extraction first = extract(scan, {}), second = extract(shuffled(scan), {});
    ASSERT_EQ(first.seams.size(), 1u);
    ASSERT_EQ(second.seams.size(), 1u);
    const Seam &one = first.seams[0], &other = second.seams[0];
    ASSERT_EQ(one.points.size(), other.points.size());
    for (std::size_t i = 0; i < one.points.size(); ++i) {
        EXPECT_LT((one.points[i].p - other.points[i].p).norm(), 1e-6) << i;
        EXPECT_LT((one.points[i].n1 - other.points[i].n1).norm(), 1e-7) << i;
    }
}

TEST(ExtractLaws, TwoJointsAreTwoSeams) {
    std::vector<Eigen::Vector3f> points, other;
    const Sampling sampling{0.3, 0.045, 1};
    add_corner(points, 80, 30, sampling);
    add_corner(other, 60, 30, sampling);
    const Eigen::Vector3f offset(10, 150, 40);
    for (const auto& p : other) {
        points.push_back(p + offset);
    }
    const Extraction extraction = extract(scan_of_points(points), {});
    ASSERT_EQ(extraction.seams.size(), 2u);
    EXPECT_NEAR(length_of(extraction.seams[0]), 80, 2) << "longest first";
    EXPECT_NEAR(length_of(extraction.seams[1]), 60, 2);
    for (const SeamPoint& point : extraction.seams[1].points) {
        EXPECT_LT((point.p.cast<float>() - offset).tail<2>().norm(), 0.06f);
    }
}

TEST(Degenerate, OnePointAtTheEndOfTheWorldHidesNothing) {
    Scan scan = corner_scan();
    scan.points.emplace_back(1e12f, -1e12f, 1e12f);
    const Extraction extraction = extract(scan, {});
    ASSERT_EQ(extraction.seams.size(), 1u);
    EXPECT_NEAR(length_of(extraction.seams[0]), 80, 2);
}

}  // namespace order_test
}  // namespace seampath
