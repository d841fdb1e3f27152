#include <gtest/gtest.h>

#include "datasets/dataset.hpp"
#include "tests/accuracy/measure.hpp"
#include "tests/extract/support.hpp"

/// Which side of a scan is the air, where the file does not say.
namespace seampath {
namespace sides_test {

using Eigen::Vector3d;

/// A face of `a` by `b` mm from a corner.
void add_face(std::vector<Eigen::Vector3f>& points, const Vector3d& corner, const Vector3d& a, const Vector3d& b,
              std::uint64_t stream) {
    constexpr double kPitch = 0.4, kNoise = 0.04;
    const Random random(7, stream);
    const Vector3d n = a.cross(b).normalized();
    std::uint64_t draw = 0;
    for (double u = 0; u < a.norm(); u += kPitch) {
        for (double v = 0; v < b.norm(); v += kPitch) {
            const Vector3d p = corner + u * a.normalized() + v * b.normalized() + kNoise * random.normal(draw++) * n;
            points.push_back(p.cast<float>());
        }
    }
}

/// A floor of 100 by 80 mm and a wall along a side of it.
Scan floor_and_wall(double height) {
    std::vector<Eigen::Vector3f> points;
    add_face(points, {0, 0, 0}, {100, 0, 0}, {0, 80, 0}, 1);
    add_face(points, {0, 0, 0}, {100, 0, 0}, {0, 0, height}, 2);
    return scan_of_points(std::move(points));
}

class PlatesWithEdges : public testing::TestWithParam<std::tuple<SceneKind, std::uint64_t>> {};

TEST_P(PlatesWithEdges, AreNotTakenForPans) {
    SceneOptions scene;
    scene.kind = std::get<0>(GetParam());
    ScannerOptions scanner;
    scanner.pitch_x_mm = scanner.pitch_y_mm = 0.5;
    scene.thickness_mm = 9;
    const Dataset dataset = make_dataset(scene, scanner, std::get<1>(GetParam()));
    const Extraction extraction = extract(scan_of(dataset), {});
    std::size_t outwards = 0, inwards = 0;
    for (const Seam& seam : extraction.seams) {
        for (const SeamPoint& point : seam.points) {
            for (const TruthSeam& truth : dataset.truth.seams) {
                for (const TruthPoint& at : truth.points) {
                    if ((at.p - point.p).norm() < 0.5) {
                        ((at.n1 + at.n2).dot(point.n1 + point.n2) > 0 ? outwards : inwards) += 1;
                    }
                }
            }
        }
    }
    EXPECT_GT(outwards, 0u);
    EXPECT_EQ(inwards, 0u) << extraction.orientation_reason;
}

INSTANTIATE_TEST_SUITE_P(Scenes, PlatesWithEdges,
                         testing::Combine(testing::Values(SceneKind::lap, SceneKind::multi),
                                          testing::Values(std::uint64_t{1}, std::uint64_t{2})));

TEST(FloorAndWall, AreAJointWhereTheWallIsHigh) {
    EXPECT_EQ(extract(floor_and_wall(30), {}).seams.size(), 1u);
}

TEST(FloorAndWall, AreAPlateAndItsEdgeWhereTheWallIsLow) {
    const Extraction extraction = extract(floor_and_wall(8), {});
    EXPECT_EQ(extraction.seams.size(), 0u);
    EXPECT_NE(extraction.orientation_reason.find("its outline has no edges"), std::string::npos)
        << extraction.orientation_reason;
}

/// What is seen of a block from above: its top, 60 by 45 mm, and its sides.
std::vector<Eigen::Vector3f> top_and_sides(double height, int sides) {
    std::vector<Eigen::Vector3f> points;
    add_face(points, {0, 0, 0}, {60, 0, 0}, {0, 45, 0}, 1);
    const Vector3d down(0, 0, -height);
    add_face(points, {0, 0, 0}, {60, 0, 0}, down, 2);
    add_face(points, {0, 0, 0}, {0, 45, 0}, down, 3);
    add_face(points, {0, 45, 0}, {60, 0, 0}, down, 4);
    if (sides == 4) {
        add_face(points, {60, 0, 0}, {0, 45, 0}, down, 5);
    }
    return points;
}

TEST(Blocks, HaveNoFilletsHoweverHighTheyAre) {
    for (const int sides : {3, 4}) {
        for (const double height : {6.0, 14.0, 30.0, 44.0}) {
            const Extraction extraction = extract(scan_of_points(top_and_sides(height, sides)), {});
            EXPECT_EQ(extraction.seams.size(), 0u)
                << sides << " sides of " << height << " mm: " << extraction.orientation_reason;
        }
    }
}

/// A plate of 100 by 60 mm, 9 mm thick on three sides, from whose fourth a face hangs down; all turned, as parts lie.
Scan plate_with_hanging_face(double hanging) {
    std::vector<Eigen::Vector3f> points;
    add_face(points, {0, 0, 0}, {100, 0, 0}, {0, 60, 0}, 1);
    add_face(points, {0, 0, 0}, {100, 0, 0}, {0, 0, -9}, 2);
    add_face(points, {0, 60, 0}, {100, 0, 0}, {0, 0, -9}, 3);
    add_face(points, {0, 0, 0}, {0, 60, 0}, {0, 0, -9}, 4);
    add_face(points, {100, 0, 0}, {0, 60, 0}, {0, 0, -hanging}, 5);
    const Eigen::Quaternionf turn = Eigen::Quaternionf(0.4F, -0.7F, 0.2F, 0.5F).normalized();
    for (Eigen::Vector3f& p : points) {
        p = turn * p;
    }
    return scan_of_points(std::move(points));
}

// 30 mm are less than a third of the 100 that the plate goes on for, but it is 9 mm thick.
TEST(Rims, AreKnownFromTheOtherRimsOfTheirPlate) {
    ExtractOptions options;
    options.joint = JointChoice::corner;
    for (const double hanging : {30.0, 60.0}) {
        const Extraction extraction = extract(plate_with_hanging_face(hanging), options);
        ASSERT_EQ(extraction.seams.size(), 1u) << hanging << " mm";
        EXPECT_NEAR(length_of(extraction.seams[0]), 60, 2) << hanging << " mm";
    }
    EXPECT_TRUE(extract(plate_with_hanging_face(9), options).seams.empty());
}

}  // namespace sides_test
}  // namespace seampath
