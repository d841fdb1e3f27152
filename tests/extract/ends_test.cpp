#include <gtest/gtest.h>

#include "datasets/dataset.hpp"
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

// The end of a web whose course runs straight as far as noise lets it be seen, but is no quadratic over the length of
// two windows.
TEST(Ends, ThatSeemStraightAreNoWorseThanTheRest) {
    SceneOptions scene;
    scene.kind = SceneKind::s_curve;
    const Dataset dataset = make_dataset(scene, preset("standard"), 6);
    const TruthSeam& truth = dataset.truth.seams.back();
    std::vector<Eigen::Vector3f> near;
    for (const Eigen::Vector3f& p : dataset.points) {
        if (p.allFinite() && (p.cast<double>() - truth.points.back().p).norm() < 120) {
            near.push_back(p);
        }
    }
    std::size_t beside = 0;
    double worst = 0;
    for (const Seam& seam : extract(scan_of_points(std::move(near)), {}).seams) {
        for (const SeamPoint& point : seam.points) {
            const auto nearest = std::min_element(
                truth.points.begin(), truth.points.end(), [&](const TruthPoint& a, const TruthPoint& b) {
                    return (a.p - point.p).squaredNorm() < (b.p - point.p).squaredNorm();
                });
            const Eigen::Vector3d off = point.p - nearest->p;
            if (off.norm() < 1.5 && (point.p - truth.points.back().p).norm() < 20) {
                worst = std::max(worst, (off - off.dot(nearest->tangent) * nearest->tangent).norm());
                beside += 1;
            }
        }
    }
    EXPECT_GT(beside, 15u);
    EXPECT_LT(worst, 0.06) << "1-sigma of a scan point is 0.045";
}

}  // namespace ends_test
}  // namespace seampath
