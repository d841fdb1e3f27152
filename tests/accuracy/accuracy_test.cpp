#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/accuracy/measure.hpp"

/// The limits of seams and models, on scans of smaller parts than the accuracy program's and of other seeds.
namespace seampath {
namespace accuracy_test {

struct Case {
    SceneKind kind;
    std::uint64_t seed;
    double size;  ///< of the part against the usual one
};

/// The usual dimensions of the scene, in mm, times the case's size; angles stay.
SceneOptions small_part(const Case& c) {
    SceneOptions o;
    o.kind = c.kind;
    o = resolved(o, c.seed);
    for (std::optional<double> SceneOptions::*dimension :
         {&SceneOptions::length_mm, &SceneOptions::width_mm, &SceneOptions::height_mm, &SceneOptions::thickness_mm,
          &SceneOptions::amplitude_mm, &SceneOptions::wavelength_mm, &SceneOptions::corner_radius_mm,
          &SceneOptions::header_radius_mm, &SceneOptions::header_length_mm, &SceneOptions::radius_mm,
          &SceneOptions::offset_mm, &SceneOptions::plate_thickness_mm, &SceneOptions::margin_mm}) {
        if (o.*dimension) {
            *(o.*dimension) *= c.size;
        }
    }
    return o;
}

class AccuracyOf : public testing::TestWithParam<Case> {};
std::string scene_of(const testing::TestParamInfo<Case>& which) {
    std::string text(name(which.param.kind));
    std::replace(text.begin(), text.end(), '-', '_');
    return text;
}
INSTANTIATE_TEST_SUITE_P(, AccuracyOf,
                         testing::Values(Case{SceneKind::tee, 41, 0.6}, Case{SceneKind::s_curve, 42, 0.6},
                                         Case{SceneKind::box_on_plate, 43, 0.7},
                                         Case{SceneKind::pipe_on_plate, 44, 0.6},
                                         Case{SceneKind::pipe_on_pipe, 45, 0.6},
                                         Case{SceneKind::pipe_on_pipe_oblique, 46, 0.6},
                                         Case{SceneKind::pipe_on_pipe_equal, 47, 0.6}),
                         scene_of);

TEST_P(AccuracyOf, SeamsAndModelsHoldTheLimits) {
    const Dataset dataset = make_dataset(small_part(GetParam()), {}, GetParam().seed);
    const Accuracy accuracy = measure_accuracy(dataset);
    EXPECT_THAT(missed(accuracy, {}), testing::IsEmpty());
    EXPECT_EQ(accuracy.seams, accuracy.true_seams);
    EXPECT_LT(accuracy.extracted.repeated_share, 0.02);
    EXPECT_LT(accuracy.fitted.repeated_share, 0.02);
    // A right model is found right by the scan itself.
    EXPECT_EQ(accuracy.passed, accuracy.seams) << "validated rms " << accuracy.validated_rms_mm;
}

class AccuracyOfCorners : public testing::TestWithParam<std::tuple<Course, std::uint64_t>> {};
INSTANTIATE_TEST_SUITE_P(Courses, AccuracyOfCorners,
                         testing::Combine(testing::Values(Course::straight, Course::arc),
                                          testing::Values(std::uint64_t{51}, std::uint64_t{52})));

TEST_P(AccuracyOfCorners, IsThatOfTheJointAndNotOfAnyRim) {
    const auto [course, seed] = GetParam();
    SceneOptions scene;
    scene.kind = SceneKind::corner;
    scene.course = course;
    ExtractOptions options;
    options.joint = JointChoice::corner;
    const Accuracy accuracy = measure_accuracy(make_dataset(scene, {}, seed), options);
    EXPECT_THAT(missed(accuracy, {0.02, 0.05, 0.99, 0, 1.5}), testing::IsEmpty());
    EXPECT_EQ(accuracy.seams, 1u);
    EXPECT_EQ(accuracy.extracted.wrong_kind_share, 0);
    EXPECT_EQ(accuracy.passed, 1u);
}

TEST(Corners, AreNotReportedUnlessAskedFor) {
    SceneOptions scene;
    scene.kind = SceneKind::corner;
    scene.length_mm = 60;
    ScannerOptions scanner;
    scanner.views = 3;
    const Scan scan = scan_of(make_dataset(scene, scanner, 53));
    EXPECT_TRUE(extract(scan, {}).seams.empty());
    ExtractOptions convex;
    convex.convex = true;
    ASSERT_EQ(extract(scan, convex).seams.size(), 1u);
    EXPECT_EQ(extract(scan, convex).seams[0].kind, JointKind::corner);
}

TEST(Missed, NamesEachLimit) {
    Accuracy accuracy;
    accuracy.extracted = accuracy.fitted = {0.01, 0.02, 0.05, 1, 0, 0, {0.3, 0.2}};
    EXPECT_THAT(missed(accuracy, {}), testing::IsEmpty());
    accuracy.extracted.rms_mm = 0.04;
    accuracy.extracted.found = 0.9;
    accuracy.fitted.max_mm = 0.2;
    accuracy.fitted.false_share = 0.1;
    accuracy.fitted.end_errors_mm = {0.1, 7};
    EXPECT_THAT(
        missed(accuracy, {}),
        testing::ElementsAre("extracted rms 0.0400 > 0.030", "extracted not found 0.1000 > 0.020",
                             "fitted max 0.2000 > 0.120", "fitted false 0.1000 > 0.020", "fitted end 7.0000 > 1.500"));
    accuracy.extracted.rms_mm = std::nan("");
    EXPECT_THAT(missed(accuracy, {}), testing::Contains(testing::StartsWith("extracted rms nan")));
}

}  // namespace accuracy_test
}  // namespace seampath
