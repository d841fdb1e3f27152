#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/scanner.hpp"
#include "stages/error.hpp"
#include "tests/extract/support.hpp"

/// Scans without a joint, and scans that can't carry a measurement.
namespace seampath {
namespace no_seam_test {

using Eigen::Vector3d;
using testing::StartsWith;
using testing::ThrowsMessage;

const Sampling kUsual{0.3, 0.045, 2};

std::string seams_of(const std::vector<Eigen::Vector3f>& points) {
    std::string lengths;
    for (const Seam& seam : extract(scan_of_points(points), {}).seams) {
        lengths += std::to_string(length_of(seam)) + " mm from " + std::to_string(seam.points.front().p.x()) + " " +
                   std::to_string(seam.points.front().p.y()) + " " + std::to_string(seam.points.front().p.z()) + "; ";
    }
    return lengths;
}

std::vector<Eigen::Vector3f> sphere(double radius, const Sampling& sampling) {
    const Random random(sampling.seed, 0);
    std::vector<Eigen::Vector3f> points;
    const auto count = static_cast<std::uint64_t>(4 * 3.1416 * radius * radius / (sampling.pitch * sampling.pitch));
    for (std::uint64_t i = 0; i < count; ++i) {
        const Vector3d direction(random.normal(4 * i), random.normal(4 * i + 1), random.normal(4 * i + 2));
        points.push_back(((radius + sampling.sigma * random.normal(4 * i + 3)) * direction.normalized()).cast<float>());
    }
    return points;
}

/// The views of a scene that holds these surfaces only.
std::vector<Eigen::Vector3f> scanned(const std::vector<Surface>& surfaces, const Eigen::AlignedBox3d& box) {
    Scene scene;
    scene.surfaces = surfaces;
    scene.box = box;
    std::vector<Eigen::Vector3f> points;
    ScannerOptions options;
    options.ghosts = 0;  // they come from joints
    for (int view = 0; view < options.views; ++view) {
        for (const Vector3d& p : take_view(scene, options, 5, view, 0).points) {
            if (p.allFinite()) {
                points.push_back(p.cast<float>());
            }
        }
    }
    return points;
}

/// A box with its corners at `low` and `high`.
std::vector<Surface> block(const Vector3d& low, const Vector3d& high) {
    std::vector<SceneShape> sides;
    for (int axis = 0; axis < 3; ++axis) {
        sides.push_back(PlaneShape{low, -Vector3d::Unit(axis)});
        sides.push_back(PlaneShape{high, Vector3d::Unit(axis)});
    }
    std::vector<Surface> surfaces;
    for (std::size_t i = 0; i < sides.size(); ++i) {
        Surface surface{sides[i], {}};
        for (std::size_t k = 0; k < sides.size(); ++k) {
            if (k != i) {
                surface.inside_of.push_back(sides[k]);
            }
        }
        surfaces.push_back(surface);
    }
    return surfaces;
}

TEST(NoSeam, OnOnePlane) {
    std::vector<Eigen::Vector3f> points;
    add_rectangle(points, {0, 0, 0}, Vector3d::UnitX(), 100, Vector3d(0, 0.6, 0.8), 80, kUsual);
    EXPECT_EQ(seams_of(points), "");
}

TEST(NoSeam, OnTwoPlanesThatDoNotMeet) {
    std::vector<Eigen::Vector3f> points;
    add_rectangle(points, {0, 0, 0}, Vector3d::UnitX(), 80, Vector3d::UnitY(), 60, kUsual);
    add_rectangle(points, {0, 0, 12}, Vector3d::UnitX(), 80, Vector3d::UnitY(), 60, kUsual);
    EXPECT_EQ(seams_of(points), "");
}

TEST(NoSeam, OnASphere) {
    EXPECT_EQ(seams_of(sphere(30, kUsual)), "");
}

TEST(NoSeam, OnAPipe) {
    std::vector<Eigen::Vector3f> points;
    add_cylinder(points, 30, 60, kUsual);
    EXPECT_EQ(seams_of(points), "");
}

TEST(NoSeam, OnAPlateOfFiniteThickness) {
    EXPECT_EQ(seams_of(scanned(block({-60, -50, -10}, {60, 50, 0}), {Vector3d(-60, -50, -10), Vector3d(60, 50, 0)})),
              "");
}

TEST(NoSeam, OnABoxThatStandsOnNothing) {
    EXPECT_EQ(seams_of(scanned(block({-50, -40, 0}, {50, 40, 60}), {Vector3d(-50, -40, 0), Vector3d(50, 40, 60)})), "");
}

TEST(NoSeam, InAFogOfPoints) {
    const Random random(8, 0);
    std::vector<Eigen::Vector3f> points;
    for (std::uint64_t i = 0; i < 4000; ++i) {
        points.push_back(
            (50 * Vector3d(random.uniform(3 * i), random.uniform(3 * i + 1), random.uniform(3 * i + 2))).cast<float>());
    }
    EXPECT_EQ(seams_of(points), "");
}

TEST(NoSeam, OnALineOfPoints) {
    std::vector<Eigen::Vector3f> points;
    points.reserve(3000);
    for (int i = 0; i < 3000; ++i) {
        points.emplace_back(0.1f * static_cast<float>(i), 0.f, 0.f);
    }
    EXPECT_EQ(seams_of(points), "");
}

TEST(NoSeam, OnAFewHundredPointsOfACorner) {
    // Enough to be taken, too few to measure with: nothing may be made up.
    std::vector<Eigen::Vector3f> points;
    add_corner(points, 10, 10, {0.9, 0.3, 3});
    ASSERT_GT(points.size(), 200u);
    for (const Seam& seam : extract(scan_of_points(points), {}).seams) {
        for (const SeamPoint& point : seam.points) {
            EXPECT_LT(point.p.tail<2>().norm(), 1);
        }
    }
}

TEST(NoMeasurement, OnThreePoints) {
    EXPECT_THAT(
        [] {
            seams_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
        },
        ThrowsMessage<InputError>(StartsWith("extract: the scan has 3 points")));
}

TEST(NoMeasurement, OnNoPoints) {
    EXPECT_THAT([] { seams_of({}); }, ThrowsMessage<InputError>(StartsWith("extract: the scan has 0 points")));
}

TEST(NoMeasurement, WhereAllPointsAreInOnePlace) {
    EXPECT_THAT(
        [] {
            seams_of(std::vector<Eigen::Vector3f>(5000, {1, 2, 3}));
        },
        ThrowsMessage<InputError>(StartsWith("extract: all points lie in one place")));
}

class OtherKinds : public testing::TestWithParam<JointChoice> {};
INSTANTIATE_TEST_SUITE_P(OfJoints, OtherKinds,
                         testing::Values(JointChoice::lap, JointChoice::butt, JointChoice::v_groove,
                                         JointChoice::saddle));

TEST_P(OtherKinds, ThanTheScanShowsGiveNoSeamAndSayWhatThereIs) {
    ExtractOptions options;
    options.joint = GetParam();
    const Extraction extraction = extract(corner_scan(40), options);
    EXPECT_TRUE(extraction.seams.empty());
    EXPECT_THAT(extraction.remarks, testing::Contains(testing::HasSubstr("but the scan shows a fillet")));
}

// Of a web that the plate is seen on both sides of, nobody can take the inside for the outside.
TEST(Corner, AskedOfAFilletGivesNoSeamAndSaysWhatThereIs) {
    std::vector<Eigen::Vector3f> points;
    for (const double side : {-1.0, 1.0}) {  // of a web of 8 mm on a plate
        add_rectangle(points, {0, 4 * side, 0}, Vector3d::UnitX(), 60, side * Vector3d::UnitY(), 25, kUsual);
        add_rectangle(points, {0, 4 * side, 0}, Vector3d::UnitX(), 60, Vector3d::UnitZ(), 25, kUsual);
    }
    ExtractOptions options;
    options.joint = JointChoice::corner;
    const Extraction extraction = extract(scan_of_points(std::move(points)), options);
    EXPECT_TRUE(extraction.seams.empty());
    EXPECT_THAT(extraction.remarks, testing::Contains(testing::HasSubstr("but the scan shows a fillet")));
}

// Two faces alone may be either: who asks for a corner is believed, and told.
TEST(Corner, AskedOfTwoFacesIsFound) {
    ExtractOptions options;
    options.joint = JointChoice::corner;
    const Extraction extraction = extract(corner_scan(40), options);
    ASSERT_EQ(extraction.seams.size(), 1u);
    EXPECT_EQ(extraction.seams[0].kind, JointKind::corner);
    EXPECT_NE(extraction.orientation_reason.find("since corners were asked for"), std::string::npos);
}

TEST(Degenerate, ExactCornerIsFound) {
    const Extraction extraction = extract(corner_scan(80, 0), {});
    ASSERT_EQ(extraction.seams.size(), 1u);
    for (const SeamPoint& point : extraction.seams[0].points) {
        EXPECT_LT(point.p.tail<2>().norm(), 1e-3);
    }
}

TEST(Degenerate, PointsPiledUpInOnePlaceHideNothing) {
    Scan scan = corner_scan();
    scan.points.insert(scan.points.end(), 3000, scan.points[1234]);
    const Extraction extraction = extract(scan, {});
    ASSERT_EQ(extraction.seams.size(), 1u);
    EXPECT_NEAR(length_of(extraction.seams[0]), 80, 2);
}

TEST(Degenerate, StrayPointsFarAwayHideNothing) {
    Scan scan = corner_scan();
    for (int i = 0; i < 200; ++i) {
        scan.points.emplace_back(10.f * static_cast<float>(i * i), -7.f * static_cast<float>(i * i), 5000.f);
    }
    const Extraction extraction = extract(scan, {});
    ASSERT_EQ(extraction.seams.size(), 1u);
    EXPECT_NEAR(length_of(extraction.seams[0]), 80, 2);
}

}  // namespace no_seam_test
}  // namespace seampath
