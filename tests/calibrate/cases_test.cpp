#include "tests/calibrate/cases.hpp"

#include <algorithm>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/error.hpp"

/// A few seeds of each; build/seampath_fixture prints all.
namespace seampath {
namespace cases_test {

using Eigen::Vector3d;
using testing::HasSubstr;

TEST(FixtureCases, BallsAmongClutterGiveTheFrame) {
    const CaseResult r = ball_case(1, 5);
    EXPECT_LE(r.rms_mm, 0.01);
    EXPECT_EQ(r.good, 5) << r.note;
    EXPECT_GE(r.inside, 4);
}

TEST(FixtureCases, TheBallThatMovedIsNamed) {
    EXPECT_EQ(moved_ball_case(1, 4).good, 4);
}

// Errors are as large as the covariance says, which is that of the measurements' own noise.
TEST(FixtureCases, TouchedPointsPlanesAndBoardsReachTheNoisesOwnLimit) {
    constexpr int kSets = 40;
    for (const CaseResult& r : {touched_case(Touched::points, 1, kSets), touched_case(Touched::three_points, 1, kSets),
                                touched_case(Touched::planes, 1, kSets), probed_case(1, kSets), board_case(1, kSets)}) {
        EXPECT_EQ(r.good, kSets) << r.note;
        EXPECT_NEAR(r.rms_mm / r.sigma_mm, 1, 0.25);
        EXPECT_GE(r.inside, 34);  // of 40 with 95 % each, fewer come once in 100
    }
}

TEST(FixtureCases, AScanIsLaidOnAMeshWithoutAGuess) {
    const CaseResult r = surface_case(1, 1, 320);
    EXPECT_EQ(r.good, 1) << r.note;
    EXPECT_LE(r.largest_mm, 0.02);
}

TEST(FixtureCases, OnAGoldenScanAFrameIsRightOrRefused) {
    const CaseResult r = golden_case(1, 2, 256);
    EXPECT_EQ(r.good, 2) << r.note;
    EXPECT_GE(r.measured, 1);
}

TEST(FixtureCases, APartThatComesBackIsLaidOnItsGoldenScan) {
    const CaseResult r = same_side_case(2, 3, 256);
    EXPECT_EQ(r.good, 3) << r.note;
    EXPECT_LE(r.largest_mm, 0.02);
}

TEST(FixtureCases, PartsWithoutAPoseOfTheirOwnAreRefusedByName) {
    for (const std::uint64_t seed : {2, 5}) {  // a sleeve slides; a flange with four lugs turns by a quarter
        const CaseResult r = open_surface_case(seed, 1, 256);
        EXPECT_EQ(r.good, 1) << r.note;
    }
}

/// What probing says of planes that the scan does not show as they are meant.
std::string refusal(ProbedPart part, const std::function<void(ProbedPart&, ProbeOptions&)>& spoil) {
    ProbeOptions options;
    options.near = part.near;
    spoil(part, options);
    try {
        probe_planes(part.scan, part.planes, options);
        return "";
    } catch (const InputError& error) {
        return error.what();
    }
}

TEST(ProbePlanes, SaysWhereTheScanDoesNotShowThem) {
    const ProbedPart part = make_probed_part(3);
    EXPECT_EQ(refusal(part, [](ProbedPart&, ProbeOptions&) {}), "");
    EXPECT_THAT(refusal(part,
                        [](ProbedPart& p, ProbeOptions&) {
                            p.planes[1].touched[0].nominal = {20, 0, 90};
                        }),
                HasSubstr("datum plane B: about (20, 0, 90) the scan shows too little of it"));
    EXPECT_THAT(
        refusal(part, [](ProbedPart& p, ProbeOptions&) { p.planes[2].normal = Vector3d(1, 0.25, 0).normalized(); }),
        HasSubstr("datum plane C: about (0, 80, 30)"));
    EXPECT_THAT(refusal(part, [](ProbedPart&, ProbeOptions& o) { o.near.translation().x() += 300; }),
                HasSubstr("check \"near\""));
}

TEST(ProbePlanes, OrderOfThePointsChangesNothing) {
    ProbedPart part = make_probed_part(5), turned = part;
    std::reverse(turned.scan.points.begin(), turned.scan.points.end());
    ProbeOptions options;
    options.near = part.near;
    probe_planes(part.scan, part.planes, options);
    probe_planes(turned.scan, turned.planes, options);
    for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t i = 0; i < part.planes[k].touched.size(); ++i) {
            EXPECT_EQ(part.planes[k].touched[i].measured, turned.planes[k].touched[i].measured);
            EXPECT_EQ(part.planes[k].touched[i].sigma_mm, turned.planes[k].touched[i].sigma_mm);
        }
    }
}

std::string refusal(const BallScene& scene, double tolerance = 1) {
    std::vector<Vector3d> centres;
    for (const NamedPoint& ball : scene.balls) {
        centres.emplace_back(scene.mirrored ? -ball.p.x() : ball.p.x(), ball.p.y(), ball.p.z());
    }
    try {
        match_balls(scene.balls, centres, tolerance);
        return "";
    } catch (const InputError& error) {
        return error.what();
    }
}

TEST(MatchBalls, MirroredAndEqualLayoutsAreRefused) {
    BallScene scene;
    EXPECT_EQ(refusal(scene), "");
    scene.mirrored = true;
    EXPECT_THAT(refusal(scene), HasSubstr("mirror image"));
    scene.mirrored = false;
    scene.balls = {{"A", {0, 0, 0}}, {"B", {300, 0, 0}}, {"C", {300, 200, 0}}, {"D", {0, 200, 0}}};
    EXPECT_THAT(refusal(scene), HasSubstr("can change places"));
    scene.balls = {{"A", {0, 0, 0}}, {"B", {300, 0, 0}}};
    EXPECT_THAT(refusal(scene), HasSubstr("no three of them"));
}

TEST(MatchBalls, WhatIsMissingAndWhatIsMoreDoesNotMatter) {
    const BallScene scene;
    const std::vector<Vector3d> found{
        {900, 900, 0}, scene.balls[3].p, {5, -100, 3}, scene.balls[0].p, scene.balls[1].p};
    const auto match = match_balls(scene.balls, found, 1);
    EXPECT_EQ(match[0], 3u);
    EXPECT_EQ(match[1], 4u);
    EXPECT_EQ(match[2], std::nullopt);
    EXPECT_EQ(match[3], 1u);
}

}  // namespace cases_test
}  // namespace seampath
