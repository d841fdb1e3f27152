#include <numeric>

#include <gtest/gtest.h>

#include "stages/fit/fit.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/place/place.hpp"
#include "tests/extract/support.hpp"

/// What must hold for extraction whatever the scan: its results follow the scan's motion, order and size.
namespace seampath {
namespace laws_test {

using Eigen::Vector3d;

/// The one seam of a scan.
Seam only_seam(const Scan& scan) {
    const Extraction extraction = extract(scan, {});
    EXPECT_EQ(extraction.seams.size(), 1u);
    return extraction.seams.empty() ? Seam{} : extraction.seams.front();
}

SeamModel model_of(const Seam& seam) {
    return fit(seam, place(seam, {}), {});
}

/// A corner with a bend in its floor's plane: a cylinder on a plate, open over 200 degrees.
Scan pipe_scan() {
    std::vector<Eigen::Vector3f> points;
    const Sampling sampling{0.3, 0.045, 5};
    add_cylinder(points, 30, 25, sampling, 0.5, 4);
    add_rectangle(points, {-60, -60, 0}, Vector3d::UnitX(), 120, Vector3d::UnitY(), 120, sampling);
    std::erase_if(points, [](const Eigen::Vector3f& p) { return p.z() < 0.25f && p.head<2>().norm() < 29.8f; });
    return scan_of_points(std::move(points));
}

Scan moved(Scan scan, const Eigen::Isometry3d& move) {
    for (auto& p : scan.points) {
        p = (move * p.cast<double>()).cast<float>();
    }
    return scan;
}

TEST(ExtractLaws, CornerIsFoundWhereItIs) {
    const Seam seam = only_seam(corner_scan());
    EXPECT_FALSE(seam.closed);
    EXPECT_NEAR(length_of(seam), 80, 2);
    double squares = 0;
    for (const SeamPoint& point : seam.points) {
        squares += point.p.tail<2>().squaredNorm() / static_cast<double>(seam.points.size());
        EXPECT_GT(point.sigma_mm, 0);
        EXPECT_LT(point.sigma_mm, 0.045) << "worse than a single scan point";
    }
    EXPECT_LT(std::sqrt(squares), 0.02);
}

TEST(ExtractLaws, FlanksFaceTheAirAndTheirCrossProductPointsAlongTravel) {
    for (const Scan& scan : {corner_scan(), pipe_scan()}) {
        const Seam seam = only_seam(scan);
        ASSERT_GE(seam.points.size(), 4u);
        for (std::size_t i = 0; i + 1 < seam.points.size(); ++i) {
            const SeamPoint& point = seam.points[i];
            EXPECT_NEAR(point.n1.norm(), 1, 1e-9);
            EXPECT_NEAR(point.n2.norm(), 1, 1e-9);
            EXPECT_GT(point.n1.cross(point.n2).normalized().dot((seam.points[i + 1].p - point.p).normalized()), 0.98)
                << i;
            EXPECT_GT(std::max(point.n1.z(), point.n2.z()), 0.999) << "the floor's normal";
        }
    }
}

TEST(ExtractLaws, SeamMovesWithTheScan) {
    for (const Scan& scan : {corner_scan(), pipe_scan()}) {
        const Seam here = only_seam(scan);
        const Seam curve = with_points_between(with_points_between(here));
        const SeamModel model = model_of(here);
        for (int trial = 0; trial < 3; ++trial) {
            const Eigen::Isometry3d move = Eigen::Translation3d(100, -50 * trial, 20) *
                                           Eigen::AngleAxisd(0.7 + trial, Vector3d(1, 2 - trial, -1).normalized());
            const Seam there = only_seam(moved(scan, move));
            EXPECT_NEAR(length_of(there), length_of(here), 1);
            double squares = 0, count = 0;
            for (const SeamPoint& point : there.points) {
                const auto d = distance_across(curve, move.inverse() * point.p);
                squares += d ? *d * *d : 0;
                count += d.has_value();
            }
            // Samples are drawn by coordinates, so that other points take part: a fortieth of their noise is allowed.
            EXPECT_LT(std::sqrt(squares / count), 0.045 / 40) << "trial " << trial;
            const SeamModel model_there = model_of(there);
            EXPECT_NEAR(model_there.length_mm, model.length_mm, 1);
        }
    }
}

TEST(ExtractLaws, RepeatedIsTheSameToTheLastBit) {
    const Scan scan = pipe_scan();
    const Seam one = only_seam(scan), two = only_seam(scan);
    ASSERT_EQ(one.points.size(), two.points.size());
    for (std::size_t i = 0; i < one.points.size(); ++i) {
        EXPECT_EQ(one.points[i].p, two.points[i].p);
        EXPECT_EQ(one.points[i].n1, two.points[i].n1);
        EXPECT_EQ(one.points[i].sigma_mm, two.points[i].sigma_mm);
    }
}

TEST(ExtractLaws, PointsGivenTwiceChangeLittle) {
    Scan scan = corner_scan();
    scan.points.insert(scan.points.end(), scan.points.begin(), scan.points.end());
    const Seam seam = only_seam(scan);
    EXPECT_NEAR(length_of(seam), 80, 2);
    double squares = 0;
    for (const SeamPoint& point : seam.points) {
        squares += point.p.tail<2>().squaredNorm() / static_cast<double>(seam.points.size());
    }
    EXPECT_LT(std::sqrt(squares), 0.03);
}

TEST(ExtractLaws, FarFromTheOriginTheSeamIsTheSame) {
    Scan scan = corner_scan();
    const Seam here = only_seam(scan);
    scan.origin_mm = {5000, -3000, 2000};
    const Seam there = only_seam(scan);
    ASSERT_EQ(here.points.size(), there.points.size());
    for (std::size_t i = 0; i < here.points.size(); ++i) {
        EXPECT_LT((here.points[i].p + scan.origin_mm - there.points[i].p).norm(), 1e-9);
    }
    // Offset in the 32-bit numbers themselves, which then end at 0.0005 mm.
    const Seam rounded = only_seam(moved(corner_scan(), Eigen::Isometry3d(Eigen::Translation3d(5000, -3000, 2000))));
    for (const SeamPoint& point : rounded.points) {
        EXPECT_LT((point.p - Vector3d(5000, -3000, 2000)).tail<2>().norm(), 0.05);
    }
}

TEST(ExtractLaws, SeamScalesWithTheScan) {
    for (const float factor : {0.1f, 10.f, 1000.f}) {
        Scan scan = corner_scan();
        for (auto& p : scan.points) {
            p *= factor;
        }
        const Seam seam = only_seam(scan);
        EXPECT_NEAR(length_of(seam), 80 * factor, 2 * factor) << "factor " << factor;
        for (const SeamPoint& point : seam.points) {
            EXPECT_LT(point.p.tail<2>().norm(), 0.05 * factor);
        }
    }
}

TEST(ExtractLaws, ChannelSeenFromWithinHasTwoSeams) {
    std::vector<Eigen::Vector3f> points;
    const Sampling sampling{0.3, 0.045, 1};
    add_rectangle(points, {0, 0, 0}, Vector3d::UnitX(), 80, Vector3d::UnitY(), 40, sampling);
    add_rectangle(points, {0, 0, 0}, Vector3d::UnitX(), 80, Vector3d::UnitZ(), 30, sampling);
    add_rectangle(points, {0, 40, 0}, Vector3d::UnitX(), 80, Vector3d::UnitZ(), 30, sampling);
    Scan scan = scan_of_points(points);
    scan.sensor_mm = Vector3d(40, 20, 400);
    const Extraction extraction = extract(scan, {});
    ASSERT_EQ(extraction.seams.size(), 2u);
    EXPECT_NEAR(length_of(extraction.seams[0]) + length_of(extraction.seams[1]), 160, 4);
}

TEST(ExtractLaws, PipeAllRoundIsOneClosedSeam) {
    std::vector<Eigen::Vector3f> points;
    const Sampling sampling{0.3, 0.045, 5};
    add_cylinder(points, 30, 25, sampling);
    add_rectangle(points, {-60, -60, 0}, Vector3d::UnitX(), 120, Vector3d::UnitY(), 120, sampling);
    std::erase_if(points, [](const Eigen::Vector3f& p) { return p.z() < 0.25f && p.head<2>().norm() < 29.8f; });
    const Seam seam = only_seam(scan_of_points(points));
    EXPECT_TRUE(seam.closed);
    for (const SeamPoint& point : seam.points) {
        EXPECT_NEAR(point.p.head<2>().norm(), 30, 0.06);
        EXPECT_NEAR(point.p.z(), 0, 0.06);
    }
    EXPECT_NEAR(model_of(seam).length_mm, 2 * 3.14159265 * 30, 0.1);
}

}  // namespace laws_test
}  // namespace seampath
