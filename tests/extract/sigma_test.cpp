#include <gtest/gtest.h>

#include "tests/extract/support.hpp"

/// A seam's sigma is a promise: errors keep it over many scans, whether noise makes them or the views' registration.
namespace seampath {
namespace sigma_test {

using Eigen::Vector3d;

/// A corner along the x axis, put together from views with white noise, each shifted by N(0, registration) per axis.
/// The last one may see the wall from behind: nothing of it but some points of its edge.
Scan views_of_corner(std::uint64_t seed, int views, double registration, bool behind = false) {
    std::vector<Eigen::Vector3f> points;
    const Random random(seed, 77);
    for (int v = 0; v < views; ++v) {
        const std::uint64_t draw = 3 * static_cast<std::uint64_t>(v);
        const Eigen::Vector3f shift =
            (registration * Vector3d(random.normal(draw), random.normal(draw + 1), random.normal(draw + 2)))
                .cast<float>();
        const std::size_t begin = points.size();
        for (double x = 0; x < 45; x += 0.5) {  // row by row, as a scanner
            const Sampling sampling{0.5, 0.045, seed * 100 + static_cast<std::uint64_t>(v)};
            add_rectangle(points, {x, 0, 0}, Vector3d::UnitX(), 0.5, Vector3d::UnitY(), 20, sampling);
            if (behind && v == views - 1) {
                add_rectangle(points, {x, -0.15, 8}, Vector3d::UnitX(), 0.5, Vector3d::UnitZ(), 0.5, sampling);
            } else {
                add_rectangle(points, {x, 0, 0}, Vector3d::UnitX(), 0.5, Vector3d::UnitZ(), 20, sampling);
            }
        }
        std::for_each(points.begin() + static_cast<std::ptrdiff_t>(begin), points.end(), [&](auto& p) { p += shift; });
    }
    return scan_of_points(std::move(points));
}

struct Coverage {
    double one = 0, two = 0, registration = 0;
};

/// Shares of points within 1 and 2 sigma of the true seam, over 60 scans.
Coverage coverage(int views, double registration) {
    constexpr std::uint64_t kScans = SEAMPATH_SLOWDOWN > 1 ? 6 : 60;
    Coverage sum;
    double points = 0, squares = 0;
    for (std::uint64_t seed = 1; seed <= kScans; ++seed) {
        const Extraction extraction = extract(views_of_corner(seed, views, registration), {});
        EXPECT_EQ(extraction.seams.size(), 1u) << seed;
        EXPECT_EQ(extraction.views, views) << seed;
        squares += std::pow(extraction.registration_mm, 2) / static_cast<double>(kScans);
        for (const Seam& seam : extraction.seams) {
            for (const SeamPoint& point : seam.points) {
                const double error = point.p.tail<2>().norm();
                sum.one += error < point.sigma_mm;
                sum.two += error < 2 * point.sigma_mm;
                points += 1;
            }
        }
    }
    sum.one /= points;
    sum.two /= points;
    sum.registration = std::sqrt(squares);
    return sum;
}

// A point lies off its seam in two directions: of such errors 63 % are within one sigma (the root of both variances)
// and 98 % within two when the two are alike, 68 % and 95 % when one of them is all. All points of a scan share the
// views' shifts, so that 60 scans are 60 draws and a share is sure to 6 %.
TEST(Sigma, HoldsWhereViewsAreShifted) {
    const Coverage c = coverage(4, 0.015);
    if (SEAMPATH_SLOWDOWN > 1)
        GTEST_SKIP() << "ran, but shares need more scans than instrumented code has time for";
    EXPECT_NEAR(c.registration, 0.015, 0.002);
    EXPECT_GT(c.one, 0.54);
    EXPECT_LT(c.one, 0.78);
    EXPECT_GT(c.two, 0.90);
}

// ... which would else pass for a shift of the views that do see it.
TEST(Sigma, AViewThatSeesButAnEdgeOfAWallDoesNotMoveIt) {
    constexpr int kScans = 6;
    double off = 0;
    for (std::uint64_t seed = 1; seed <= kScans; ++seed) {
        const Extraction extraction = extract(views_of_corner(seed, 4, 0.015, true), {});
        ASSERT_EQ(extraction.seams.size(), 1u) << seed;
        EXPECT_EQ(extraction.views, 4) << seed;
        const Random random(seed, 77);
        const double shift = 0.015 * (random.normal(1) + random.normal(4) + random.normal(7)) / 3;
        for (const SeamPoint& point : extraction.seams.front().points) {
            off += (point.p.y() - shift) / static_cast<double>(extraction.seams.front().points.size()) / kScans;
        }
    }
    EXPECT_LT(std::abs(off), 0.003);
}

TEST(Sigma, OfOneViewIsThatOfItsNoise) {
    const Coverage c = coverage(1, 0);
    EXPECT_EQ(c.registration, 0);
    if (SEAMPATH_SLOWDOWN > 1)
        GTEST_SKIP() << "ran, but shares need more scans than instrumented code has time for";
    EXPECT_GT(c.one, 0.54);
    EXPECT_LT(c.one, 0.80);
    EXPECT_GT(c.two, 0.90);
}

}  // namespace sigma_test
}  // namespace seampath
