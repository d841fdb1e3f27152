#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/fixtures/fixture_scenes.hpp"
#include "stages/calibrate/calibrate.hpp"
#include "stages/error.hpp"

/// Measured seams laid on nominal ones.
namespace seampath {
namespace seam_match_test {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using testing::ElementsAre;
using testing::HasSubstr;
using Seams = std::vector<std::vector<MeasuredSeamPoint>>;

constexpr double kSigma = 0.02;

NominalSeam line(const std::string& name, const Vector3d& a, const Vector3d& b) {
    return {name, false, {a, b}};
}

NominalSeam arc(const std::string& name, const Vector3d& centre, double radius, double from, double to) {
    NominalSeam seam{name, false, {}};
    for (int i = 0; i <= 400; ++i) {
        const double a = from + (to - from) * i / 400;
        seam.points.push_back(centre + radius * Vector3d(std::cos(a), std::sin(a), 0));
    }
    return seam;
}

Isometry3d far_pose() {
    Isometry3d T = Isometry3d::Identity();
    T.linear() = Eigen::AngleAxisd(2.1, Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
    T.translation() = Vector3d(800, -300, 450);
    return T;
}

Seams measured(const std::vector<NominalSeam>& nominal, const Isometry3d& T, std::uint64_t seed) {
    return measured_seams(nominal, T, kSigma, seed);
}

std::vector<NominalSeam> three() {
    return SeamScene().seams;
}

FrameOptions quick() {
    FrameOptions options;
    options.trials = 1000;
    return options;
}

TEST(SeamMatch, FindsTheFrameFromAnyPoseToTheNoisesOwnLimit) {
    double squares = 0;
    constexpr int kSets = 2;
    double expanded = 0;
    for (std::uint64_t seed = 1; seed <= kSets; ++seed) {
        const FrameResult r =
            calibrate_seams(three(), measured(three(), far_pose(), seed), {{"w", {90, 60, 20}}}, quick());
        EXPECT_TRUE(r.pass()) << r.faults.front();
        squares += (r.base_from_part * Vector3d(90, 60, 20) - far_pose() * Vector3d(90, 60, 20)).squaredNorm() / kSets;
        expanded = r.work_points.front().expanded_mm;
    }
    EXPECT_LT(std::sqrt(squares), expanded);  // the distance that 95 % keep
    EXPECT_LT(expanded, kSigma);              // some hundred points hold it better than one does
}

TEST(SeamMatch, AStraightSeamLeavesItsDirectionAndItsTurnOpen) {
    const std::vector<NominalSeam> one{line("A", {0, 0, 0}, {150, 0, 0})};
    const FrameResult r = calibrate_seams(one, measured(one, far_pose(), 1), {}, quick());
    EXPECT_FALSE(r.pass());
    ASSERT_EQ(r.weak.size(), 2u);
    EXPECT_EQ(r.weak[0].text, "shift along (1.000, 0.000, 0.000)");
    EXPECT_THAT(r.weak[1].text, HasSubstr("turn about (1.000, 0.000, 0.000)"));
}

TEST(SeamMatch, TheSeamThatMovedIsNamed) {
    std::vector<NominalSeam> nominal = three();
    nominal.push_back(line("D", {200, 20, 10}, {200, 110, 10}));
    nominal.push_back(line("E", {40, 140, 70}, {150, 150, 40}));
    std::vector<NominalSeam> real = nominal;
    for (Vector3d& p : real[4].points) {
        p.z() += 0.3;
    }
    const FrameResult r = calibrate_seams(nominal, measured(real, far_pose(), 2), {{"w", {90, 60, 20}}}, quick());
    EXPECT_FALSE(r.pass());
    EXPECT_THAT(r.moved, ElementsAre("E"));
}

TEST(SeamMatch, SeamsThatFitInTwoPosesAreRefused) {
    const NominalSeam frame{"frame", true, {{0, 0, 0}, {160, 0, 0}, {160, 90, 0}, {0, 90, 0}}};
    NominalSeam drawn = frame;  // to the first point again, and on: nothing is cut off
    drawn.points.insert(drawn.points.end(), {{0, 0, 0}, {160, 0, 0}});
    const FrameResult r = calibrate_seams({frame}, measured({drawn}, far_pose(), 3), {}, quick());
    EXPECT_FALSE(r.pass());
    EXPECT_THAT(r.faults.front(), HasSubstr("ambiguous"));
}

TEST(SeamMatch, OrderOfSeamsChangesNothing) {
    Seams seams = measured(three(), far_pose(), 4);
    const FrameResult a = calibrate_seams(three(), seams, {}, quick());
    std::reverse(seams.begin(), seams.end());
    const FrameResult b = calibrate_seams(three(), seams, {}, quick());
    EXPECT_TRUE(a.base_from_part.isApprox(b.base_from_part, 1e-12));
}

TEST(SeamMatch, SaysWhatItLacks) {
    const auto message = [](const std::vector<NominalSeam>& nominal, const Seams& seams) -> std::string {
        try {
            calibrate_seams(nominal, seams, {}, quick());
            return "";
        } catch (const InputError& error) {
            return error.what();
        }
    };
    EXPECT_THAT(message(three(), {}), HasSubstr("0 measured points"));
    EXPECT_THAT(message({line("A", {1, 1, 1}, {1, 1, 1})}, measured(three(), far_pose(), 1)), HasSubstr("no length"));
    EXPECT_THAT(message({arc("ring", {0, 0, 0}, 400, 0, 3)}, measured(three(), far_pose(), 1)),
                HasSubstr("no pose was found"));
}

}  // namespace seam_match_test
}  // namespace seampath
