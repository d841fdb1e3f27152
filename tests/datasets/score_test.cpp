#include "datasets/score.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/datasets/scene_laws.hpp"

namespace seampath {
namespace score_test {

using testing::DoubleNear;
using testing::Each;
using testing::SizeIs;

Truth truth_of(SceneKind kind) {
    return make_scene(scene_options(static_cast<int>(kind))).truth;
}

/// Every tenth true point from `begin` to `end`, moved by `shift` along the first flank's normal.
Seam report(const TruthSeam& seam, double shift = 0, double begin = 0, double end = 1) {
    Seam reported;
    reported.kind = seam.kind;
    reported.closed = seam.closed && begin == 0 && end == 1;
    const auto n = static_cast<double>(seam.points.size());
    for (auto i = static_cast<std::size_t>(begin * n); i < static_cast<std::size_t>(end * n); i += 10) {
        const TruthPoint& point = seam.points[i];
        reported.points.push_back({point.p + shift * point.n1, point.n1, point.n2});
    }
    if (end == 1 && !seam.closed) {
        const TruthPoint& point = seam.points.back();
        reported.points.push_back({point.p + shift * point.n1, point.n1, point.n2});
    }
    return reported;
}

std::vector<Seam> report_all(const Truth& truth, double shift = 0) {
    std::vector<Seam> seams;
    for (const TruthSeam& seam : truth.seams) {
        seams.push_back(report(seam, shift));
    }
    return seams;
}

class ScoreOfScene : public testing::TestWithParam<SceneOptions> {};
INSTANTIATE_TEST_SUITE_P(Scenes, ScoreOfScene, all_scenes(), scene_test_name);

TEST_P(ScoreOfScene, TruthIsPerfect) {
    const Truth truth = make_scene(resolved(GetParam(), 1)).truth;
    const Score s = score(report_all(truth), truth);
    EXPECT_LT(s.max_mm, 1e-9);
    EXPECT_NEAR(s.found, 1, 1e-9);
    EXPECT_EQ(s.false_share, 0);
    EXPECT_NEAR(s.repeated_share, 0, 1e-4);
    EXPECT_THAT(s.end_errors_mm, Each(DoubleNear(0, 1e-9)));
    const auto open =
        std::count_if(truth.seams.begin(), truth.seams.end(), [](const auto& seam) { return !seam.closed; });
    EXPECT_THAT(s.end_errors_mm, SizeIs(static_cast<std::size_t>(2 * open)));
    EXPECT_EQ(s.wrong_kind_share, 0);
}

TEST_P(ScoreOfScene, ShiftIsMeasured) {
    const Truth truth = make_scene(resolved(GetParam(), 1)).truth;
    const Score s = score(report_all(truth, 0.3), truth);
    const double shift = truth.seams.empty() ? 0 : 0.3;
    EXPECT_NEAR(s.rms_mm, shift, 1e-4);
    EXPECT_NEAR(s.p95_mm, shift, 1e-4);
    EXPECT_NEAR(s.max_mm, shift, 1e-4);
    EXPECT_NEAR(s.found, 1, 1e-9);
    EXPECT_EQ(s.false_share, 0);
}

TEST(Score, ErrorsHaveTheirTwoPartsInTheSection) {
    const Truth truth = truth_of(SceneKind::tee);
    std::vector<Seam> seams = report_all(truth);
    for (std::size_t i = 0; i < seams.size(); ++i) {
        const TruthPoint& at = truth.seams[i].points[0];
        const Eigen::Vector3d up = (at.n1 + at.n2).normalized();
        for (SeamPoint& point : seams[i].points) {
            point.p += 0.03 * up - 0.04 * at.tangent.cross(up);
        }
    }
    const Score s = score(seams, truth);
    EXPECT_NEAR(s.vertical_mean_mm, 0.03, 1e-9);
    EXPECT_NEAR(s.vertical_rms_mm, 0.03, 1e-9);
    EXPECT_NEAR(s.lateral_mean_mm, -0.04, 1e-9);
    EXPECT_NEAR(s.lateral_rms_mm, 0.04, 1e-9);
    EXPECT_NEAR(s.p50_mm, 0.05, 1e-9);
}

TEST(Score, FeetCarryTheTrueFrame) {
    const Truth truth = truth_of(SceneKind::tee);
    const TruthPoint& at = truth.seams[0].points[500];
    const auto feet = truth_feet(std::vector<Eigen::Vector3d>{at.p + 0.2 * at.n1, at.p + 9 * at.n1}, truth);
    EXPECT_NEAR(feet[0].distance_mm, 0.2, 1e-9);
    EXPECT_LT((feet[0].at.p - at.p).norm(), 1e-9);
    EXPECT_LT((feet[0].at.n1 - at.n1).norm() + (feet[0].at.tangent - at.tangent).norm(), 1e-9);
    EXPECT_TRUE(std::isinf(feet[1].distance_mm));
}

TEST(Score, DistanceIsFromTheCurveNotFromItsSamples) {
    Truth truth = truth_of(SceneKind::box_on_plate);
    const std::vector<Seam> seams = report_all(truth);
    TruthSeam thinned{true, {}, JointKind::fillet, {}};
    for (std::size_t i = 0; i + 5 < truth.seams[0].points.size(); i += 7) {
        thinned.points.push_back(truth.seams[0].points[i]);
    }
    truth.seams = {thinned};
    EXPECT_LT(score(seams, truth).max_mm, 2e-3);  // the samples are up to 0.35 mm away
}

TEST(Score, MissingPartLowersFoundAndShowsAtTheEnd) {
    const Truth truth = truth_of(SceneKind::tee);
    const double length = (truth.seams[0].points.back().p - truth.seams[0].points[0].p).norm();
    const std::vector<Seam> seams{report(truth.seams[0], 0, 0.2, 1), report(truth.seams[1])};
    const Score s = score(seams, truth);
    EXPECT_NEAR(s.found, 1 - (0.2 * length - kCorrespondence) / (2 * length), 1e-3);
    ASSERT_THAT(s.end_errors_mm, SizeIs(4));
    EXPECT_NEAR(s.end_errors_mm[0], 0.2 * length, 0.1);
    EXPECT_NEAR(s.end_errors_mm[1], 0, 1e-9);
    EXPECT_LT(s.max_mm, 1e-9);
}

TEST(Score, ReachingTooFarIsAnErrorOfTheEnd) {
    const Truth truth = truth_of(SceneKind::tee);
    std::vector<Seam> seams = report_all(truth);
    const TruthPoint& last = truth.seams[0].points.back();
    for (int i = 1; i <= 50; ++i) {
        seams[0].points.push_back({last.p + 0.1 * i * last.tangent, last.n1, last.n2});
    }
    const Score s = score(seams, truth);
    EXPECT_NEAR(s.end_errors_mm[1], 5, 1e-9);
    EXPECT_LT(s.max_mm, 1e-9);
    const double length = 2 * (last.p - truth.seams[0].points[0].p).norm();
    EXPECT_NEAR(s.false_share, (5 - kCorrespondence) / length, 1e-9);
}

TEST(Score, ForeignCurveIsFalse) {
    const Truth truth = truth_of(SceneKind::tee);
    std::vector<Seam> seams = report_all(truth);
    seams.push_back(report(truth.seams[0], 20));
    const Score s = score(seams, truth);
    EXPECT_NEAR(s.false_share, 0.5, 1e-9);
    EXPECT_LT(s.max_mm, 1e-9);
    EXPECT_NEAR(s.found, 1, 1e-9);
}

TEST(Score, SeamReportedTwiceIsRepeated) {
    const Truth truth = truth_of(SceneKind::pipe_on_pipe);
    const std::vector<Seam> seams{report(truth.seams[0]), report(truth.seams[0], 0.1)};
    EXPECT_NEAR(score(seams, truth).repeated_share, 1, 0.01);
}

TEST(Score, NothingReportedIsNothingFound) {
    const Truth truth = truth_of(SceneKind::tee);
    const Score s = score(std::vector<Seam>{}, truth);
    EXPECT_EQ(s.found, 0);
    EXPECT_EQ(s.false_share, 0);
    EXPECT_EQ(s.max_mm, 0);
    EXPECT_THAT(s.end_errors_mm,
                Each(DoubleNear((truth.seams[0].points.back().p - truth.seams[0].points[0].p).norm(), 1e-9)));
}

TEST(Score, WhatIsReportedWhereThereIsNoJointIsFalse) {
    const Truth none = truth_of(SceneKind::plain);
    ASSERT_THAT(none.seams, SizeIs(0));
    const Score silent = score(std::vector<Seam>{}, none);
    EXPECT_EQ(silent.found, 1);
    EXPECT_EQ(silent.false_share, 0);
    EXPECT_EQ(silent.repeated_share, 0);
    const Score wrong = score(std::vector<Seam>{report(truth_of(SceneKind::tee).seams[0])}, none);
    EXPECT_EQ(wrong.found, 1);
    EXPECT_TRUE(std::isinf(wrong.false_share));
    EXPECT_EQ(wrong.max_mm, 0);
}

TEST(Score, OtherKindOfJointIsCounted) {
    const Truth truth = truth_of(SceneKind::multi);
    ASSERT_THAT(truth.seams, SizeIs(5));
    std::vector<Seam> seams = report_all(truth);
    EXPECT_EQ(score(seams, truth).wrong_kind_share, 0);
    ASSERT_EQ(seams[0].kind, JointKind::lap);
    seams[0].kind = JointKind::fillet;
    const double width = (truth.seams[0].points.back().p - truth.seams[0].points.front().p).norm();
    double closed = 0;
    for (std::size_t i = 0; i < truth.seams[3].points.size(); ++i) {
        const auto& points = truth.seams[3].points;
        closed += (points[(i + 1) % points.size()].p - points[i].p).norm();
    }
    const Score s = score(seams, truth);
    EXPECT_NEAR(s.wrong_kind_share, width / (4 * width + closed), 1e-6);
    EXPECT_EQ(s.false_share, 0);
}

SeamModel straight_model(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    SeamModel model;
    const double length = (b - a).norm();
    model.curve.knots = {0, 0, 0, 0, length, length, length, length};
    model.curve.control = {a, a + (b - a) / 3, a + (b - a) * 2 / 3, b};
    return model;
}

TEST(Score, TangentsOfModelsAreComparedWithTheTrueOnes) {
    const Truth truth = truth_of(SceneKind::tee);
    const TruthPoint &first = truth.seams[0].points.front(), &last = truth.seams[0].points.back();
    const double length = (last.p - first.p).norm();
    const std::vector<SeamModel> turned{straight_model(first.p, last.p + length * std::tan(0.005) * last.n1)};
    EXPECT_NEAR(score(turned, truth).tangent_p95_deg, 0.005 * 180 / std::numbers::pi, 1e-6);
    const std::vector<SeamModel> back{straight_model(last.p, first.p)};
    EXPECT_NEAR(score(back, truth).tangent_p95_deg, 0, 1e-6) << "either flank may be the first";
}

TEST(Score, ModelIsComparedByItsCurve) {
    const Truth truth = truth_of(SceneKind::tee);
    std::vector<SeamModel> models;
    for (const TruthSeam& seam : truth.seams) {
        models.push_back(straight_model(seam.points.front().p + 0.05 * seam.points.front().n1,
                                        seam.points.back().p + 0.05 * seam.points.back().n1));
    }
    const Score s = score(models, truth);
    EXPECT_NEAR(s.rms_mm, 0.05, 1e-9);
    EXPECT_NEAR(s.found, 1, 1e-9);
    EXPECT_THAT(s.end_errors_mm, Each(DoubleNear(0, 1e-9)));
}

}  // namespace score_test
}  // namespace seampath
