#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/extract/joint_scenes.hpp"
#include "tests/extract/support.hpp"

/// Lap joints: the foot of an upper plate's edge.
namespace seampath {
namespace lap_test {

SceneOptions lap(double thickness, Course course = Course::straight) {
    SceneOptions o = small_plates(SceneKind::lap, course);
    o.thickness_mm = thickness;
    return o;
}

struct Case {
    const char* what;
    double thickness;
    Course course;
    bool usual_size = false;  // else small
};

class Laps : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(, Laps,
                         testing::Values(Case{"thin", 1.5, Course::straight, true}, Case{"thick", 9, Course::straight},
                                         Case{"arc", 3, Course::arc}, Case{"s_curve", 2.4, Course::s_curve, true}),
                         [](const auto& which) { return std::string(which.param.what); });

TEST_P(Laps, AreFoundAtTheFootOfTheStep) {
    const Case c = GetParam();
    SceneOptions scene = lap(c.thickness, c.course);
    if (c.usual_size) {
        scene = {};
        scene.kind = SceneKind::lap;
        scene.course = c.course;
        scene.thickness_mm = c.thickness;
    }
    const Found found = find_in(scene, c.usual_size ? 1 : 21);
    ASSERT_EQ(found.extraction.seams.size(), 1u);
    EXPECT_EQ(found.extraction.seams.front().kind, JointKind::lap);
    EXPECT_LE(found.score.rms_mm, 0.025);
    EXPECT_LE(found.score.max_mm, 0.08);
    EXPECT_GE(found.score.found, 0.98);
    EXPECT_EQ(found.score.false_share, 0);
    EXPECT_GT(found.within_2_sigma, 0.85);
    EXPECT_THAT(found.extraction.seams.front().kind_reason, testing::HasSubstr("mm high"));
}

TEST(LapsNot, AreMachinedSteps) {
    const Found found = find_in(lap(1.0), 22);
    EXPECT_THAT(found.extraction.seams, testing::IsEmpty());
    // It may as well be a thin sheet.
    EXPECT_THAT(found.extraction.remarks, testing::Contains(testing::AllOf(testing::HasSubstr("taken for machined"),
                                                                           testing::HasSubstr("max_step_mm"))));
    ExtractOptions options;
    options.max_step_mm = 0.6;
    const Found lower = find_in(lap(1.5), 22, options);
    EXPECT_EQ(lower.extraction.seams.size(), 1u);
}

// The table is a surface without a side of its own.
TEST(LapsNot, AreEdgesOfAPlateOnATable) {
    std::vector<Eigen::Vector3f> points;
    const Sampling sampling{0.3, 0.03, 5};
    const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
    add_rectangle(points, {0, 0, 0}, x, 60, y, 30, sampling);   // table before the edge
    add_rectangle(points, {0, 30, 0}, x, 60, z, 5, sampling);   // edge of the plate
    add_rectangle(points, {0, 30, 5}, x, 60, y, 40, sampling);  // its top
    Scan scan = scan_of_points(std::move(points));
    scan.sensor_mm = Eigen::Vector3d(30, -200, 300);
    const Extraction automatic = extract(scan, {});
    EXPECT_THAT(automatic.seams, testing::IsEmpty());
    EXPECT_THAT(automatic.remarks, testing::Contains(testing::HasSubstr("as a table does")));
    ExtractOptions forced;
    forced.joint = JointChoice::lap;
    ASSERT_EQ(extract(scan, forced).seams.size(), 1u);
}

TEST(LapsNot, AreWebsAndBoxes) {
    for (const SceneKind kind : {SceneKind::tee, SceneKind::box_on_plate}) {
        SceneOptions o;
        o.kind = kind;
        o.length_mm = 60;
        o.width_mm = 50;
        o.height_mm = 25;
        o.margin_mm = 20;
        const Found found = find_in(o, 23);
        for (const Seam& seam : found.extraction.seams) {
            EXPECT_EQ(seam.kind, JointKind::fillet) << name(kind);
        }
        EXPECT_GE(found.score.found, 0.98) << name(kind);
    }
}

TEST(LapsAmong, SpatterAreFound) {
    SceneOptions o = lap(4);
    o.kind = SceneKind::spatter;
    o.spattered = Spattered::lap;
    o.tack_spacing_mm = 200;  // none
    const Found found = find_in(o, 24);
    EXPECT_LE(found.score.rms_mm, 0.025);
    EXPECT_GE(found.score.found, 0.9);
    EXPECT_LT(found.score.wrong_kind_share, 0.02);
}

}  // namespace lap_test
}  // namespace seampath
