#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/extract/joint_scenes.hpp"

/// Square butt joints: gaps between two plates' tops.
namespace seampath {
namespace butt_test {

SceneOptions butt(double gap, double mismatch, Course course = Course::straight) {
    SceneOptions o = small_plates(SceneKind::butt, course);
    o.gap_mm = gap;
    o.mismatch_mm = mismatch;
    return o;
}

struct Case {
    const char* what;
    double gap, mismatch;
    Course course;
    double rms, max;
};

class Butts : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(, Butts,
                         testing::Values(Case{"level", 0.9, 0, Course::straight, 0.025, 0.08},
                                         Case{"mismatched", 0.9, 1.5, Course::straight, 0.025, 0.08},
                                         Case{"arc", 0.9, 0.6, Course::arc, 0.025, 0.08},
                                         Case{"narrow", 0.3, 0, Course::straight, 0.035, 0.12},
                                         Case{"wide", 1.8, 0.3, Course::straight, 0.025, 0.08}),
                         [](const auto& which) { return std::string(which.param.what); });

TEST_P(Butts, AreFoundWhereTheTopEdgesAre) {
    const Case c = GetParam();
    const Found found = find_in(butt(c.gap, c.mismatch, c.course), 11);
    ASSERT_EQ(found.extraction.seams.size(), 1u);
    const Seam& seam = found.extraction.seams.front();
    EXPECT_EQ(seam.kind, JointKind::butt);
    EXPECT_LE(found.score.rms_mm, c.rms);
    EXPECT_LE(found.score.max_mm, c.max);
    EXPECT_GE(found.score.found, 0.95);
    EXPECT_EQ(found.score.false_share, 0);
    EXPECT_GT(found.within_2_sigma, 0.85);
    ASSERT_EQ(seam.groove.size(), seam.points.size());
    for (const GrooveStation& station : seam.groove) {
        if (!std::isnan(station.gap_mm.value)) {
            EXPECT_NEAR(station.gap_mm.value, c.gap, 0.15);
            EXPECT_NEAR(std::abs(station.mismatch_mm.value), c.mismatch, 0.05);
        }
        EXPECT_TRUE(std::isnan(station.bevel1_rad.value));
    }
    // Level tops have one normal; the flanks' places are what tells them apart.
    EXPECT_GT(seam.points[5].n1.dot(seam.points[5].n2), 0.99);
}

/// Thin plates before a line profiler: their walls are as narrow as the gap, and what one wall sends to the other is
/// seen between them.
struct Sheets {
    double length, margin, thickness, gap, mismatch;
    std::uint64_t seed;
};
class ButtsOfSheets : public testing::TestWithParam<Sheets> {};
INSTANTIATE_TEST_SUITE_P(, ButtsOfSheets,
                         testing::Values(Sheets{17.4, 6.5, 1.2, 1.05, 0.91, 8}, Sheets{23.3, 4.7, 1.1, 1.49, 0.12, 15},
                                         Sheets{24.7, 6.1, 1.05, 0.66, 0.91, 4}),
                         [](const auto& which) { return "seed_" + std::to_string(which.param.seed); });

TEST_P(ButtsOfSheets, AreNeitherGroovesNorFillets) {
    const Sheets sheets = GetParam();
    SceneOptions scene = butt(sheets.gap, sheets.mismatch);
    scene.length_mm = sheets.length;
    scene.margin_mm = sheets.margin;
    scene.plate_thickness_mm = sheets.thickness;
    const Accuracy accuracy = measure_accuracy(make_dataset(scene, preset("gocator2440_robot"), sheets.seed));
    EXPECT_EQ(accuracy.seams, 1u);
    EXPECT_EQ(accuracy.extracted.wrong_kind_share, 0);
    EXPECT_EQ(accuracy.extracted.false_share, 0);
    EXPECT_GE(accuracy.extracted.found, 0.97);
    EXPECT_LE(accuracy.fitted.rms_mm, 0.08);
}

TEST(ButtsBySign, PlateTwoIsOnTheLeft) {
    const SceneOptions scene = butt(0.9, 1.2);
    const Dataset dataset = make_dataset(scene, {}, 12);
    const Extraction extraction = extract(scan_of(dataset), {});
    ASSERT_EQ(extraction.seams.size(), 1u);
    const Seam& seam = extraction.seams.front();
    const TruthSeam& truth = dataset.truth.seams.front();
    const Eigen::Vector3d travel = seam.points.back().p - seam.points.front().p;
    const double sign = travel.dot(truth.points.front().tangent) > 0 ? 1 : -1;
    const std::size_t middle = seam.groove.size() / 2;
    EXPECT_NEAR(seam.groove[middle].mismatch_mm.value, sign * 1.2, 0.05);
}

TEST(ButtsValidated, DownToOneAndAHalfPointDistances) {
    for (const double mismatch : {0.6, 1.2}) {
        const Accuracy accuracy = measure_accuracy(make_dataset(butt(0.3, mismatch), {}, 2));
        EXPECT_EQ(accuracy.passed, 1u) << mismatch;
        EXPECT_GT(accuracy.least_coverage, 0.95) << mismatch;
    }
}

TEST(ButtsForced, AndAutomaticAgree) {
    ExtractOptions options;
    options.joint = JointChoice::butt;
    const Found found = find_in(butt(0.9, 0.4), 13, options);
    ASSERT_EQ(found.extraction.seams.size(), 1u);
    EXPECT_LE(found.score.rms_mm, 0.025);
}

TEST(ButtsNot, ArePlainPlatesWithStepsAndHoles) {
    for (const double step : {0.4, 0.9}) {
        SceneOptions o;
        o.kind = SceneKind::plain;
        o.length_mm = 110;
        o.width_mm = 80;
        o.radius_mm = 5;
        o.step_mm = step;
        EXPECT_THAT(find_in(o, 14).extraction.seams, testing::IsEmpty()) << step;
    }
}

// The top edges of both plates are no web in the gap.
TEST(ButtsToo, AreFoundWhereConvexEdgesAreAskedFor) {
    ExtractOptions convex;
    convex.convex = true;
    const Found found = find_in(small_plates(SceneKind::butt), 3, convex);
    EXPECT_EQ(std::count_if(found.extraction.seams.begin(), found.extraction.seams.end(),
                            [](const Seam& seam) { return seam.kind == JointKind::butt; }),
              1);
}

// The web stands in the gap, and has a seam with both sides of the plate.
TEST(ButtsNot, AreThePlateUnderAWeb) {
    SceneOptions o;
    o.kind = SceneKind::tee;
    o.length_mm = 14;
    o.margin_mm = 6;
    o.height_mm = 8;
    o.thickness_mm = 3;
    ScannerOptions scanner = preset("metrology");
    scanner.views = 2;
    const Extraction extraction = extract(scan_of(make_dataset(o, scanner, 5)), {});
    ASSERT_EQ(extraction.seams.size(), 2u);
    for (const Seam& seam : extraction.seams) {
        EXPECT_EQ(seam.kind, JointKind::fillet);
    }
}

}  // namespace butt_test
}  // namespace seampath
