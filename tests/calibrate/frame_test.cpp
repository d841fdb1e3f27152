#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/calibrate/calibrate.hpp"
#include "stages/error.hpp"
#include "stages/geometry/pose.hpp"

namespace seampath {
namespace frame_test {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using testing::ElementsAre;
using testing::HasSubstr;

const std::vector<WorkPoint> kWork{{"near", {200, 150, 60}}, {"far", {800, 300, 0}}};

Isometry3d some_pose() {
    Isometry3d T = Isometry3d::Identity();
    T.linear() = turn_by({0.7, -1.1, 2.0}).toRotationMatrix();
    T.translation() = Vector3d(1200, -340, 55);
    return T;
}

std::vector<FrameFeature> points(const std::vector<Vector3d>& nominal, const Isometry3d& T, double sigma,
                                 std::uint64_t seed = 0) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    std::vector<FrameFeature> features;
    for (std::size_t i = 0; i < nominal.size(); ++i) {
        const Vector3d e = seed == 0 ? Vector3d::Zero() : Vector3d(normal(random), normal(random), normal(random));
        features.push_back({"P" + std::to_string(i + 1),
                            0,
                            false,
                            {{nominal[i], T * nominal[i] + sigma * e, sigma * sigma * Matrix3d::Identity()}},
                            {}});
    }
    return features;
}

const std::vector<Vector3d> kFour{{0, 0, 40}, {400, 0, 70}, {370, 290, 45}, {40, 240, 130}};

TEST(CalibrateFrame, ExactPointsGiveTheirFrame) {
    const FrameResult r = calibrate_frame(points(kFour, some_pose(), 0.01), kWork, {});
    EXPECT_LT(displacement(some_pose(), r.base_from_part).norm(), 1e-9);
    EXPECT_TRUE(r.pass());
    EXPECT_EQ(r.redundancy, 6);
    EXPECT_LT(r.chi_squared, 1e-15);
}

// Closed form: of n isotropic points, var = sigma^2 (1/n) at the centroid, and the turn's covariance is
// sigma^2 (sum (|p|^2 I - p p'))^-1.
TEST(CalibrateFrame, CovarianceIsTheClosedForm) {
    const double sigma = 0.02;
    const Isometry3d T = some_pose();
    const FrameResult r = calibrate_frame(points(kFour, T, sigma), kWork, {});
    Vector3d c = Vector3d::Zero();
    for (const auto& p : kFour) {
        c += T * p / 4;
    }
    Matrix3d I = Matrix3d::Zero();
    for (const auto& p : kFour) {
        const Vector3d w = T * p - c;
        I += w.squaredNorm() * Matrix3d::Identity() - w * w.transpose();
    }
    const Matrix3d turns = sigma * sigma * I.inverse();
    EXPECT_LT((r.covariance.bottomRightCorner<3, 3>() - turns).norm(), 1e-9 * turns.norm());
    EXPECT_LT((covariance_at(r.covariance, T, T.inverse() * c) - sigma * sigma / 4 * Matrix3d::Identity()).norm(),
              1e-12);
    for (const auto& w : r.work_points) {  // Monte-Carlo against the closed form
        const Matrix3d C = covariance_at(r.covariance, T, w.p);
        EXPECT_NEAR(w.covariance.trace() / C.trace(), 1, 0.1) << w.name;
        EXPECT_GT(w.expanded_mm, 1.6 * std::sqrt(C.trace() / 3));
        EXPECT_LT(w.expanded_mm, 2.1 * std::sqrt(C.trace()));
    }
}

TEST(CalibrateFrame, CovarianceIsWhatRepeatedMeasurementsShow) {
    int inside = 0;
    constexpr int kSets = 1000;
    for (int seed = 1; seed <= kSets; ++seed) {
        const auto features = points(kFour, some_pose(), 0.02, static_cast<std::uint64_t>(seed));
        const FrameResult r = calibrate_frame(features, {}, {});
        const Vector6 d = displacement(r.base_from_part, some_pose());
        inside += d.dot(r.covariance.ldlt().solve(d)) < 12.592;  // 95 % of a chi-squared of 6
    }
    EXPECT_GE(inside, 0.93 * kSets);
    EXPECT_LE(inside, 0.97 * kSets);
}

FrameFeature board(const std::string& name, const Isometry3d& nominal, const Isometry3d& T, const Matrix6& covariance) {
    return {name, 0, false, {}, {}, {{nominal, T * nominal, covariance, {{0, 0, 0}, {150, 0, 0}, {0, 105, 0}}}}};
}

// One pose leaves no choice: the frame is the measured pose, and its covariance that of the pose about the part's
// origin, by the change of reference alone. A second like it halves the covariance.
TEST(CalibrateFrame, APoseGivesItsFrameAndItsCovariance) {
    Isometry3d nominal = Isometry3d::Identity();
    nominal.linear() = turn_by({0.2, 0.1, -0.4}).toRotationMatrix();
    nominal.translation() = Vector3d(300, 40, -20);
    Matrix6 C = Matrix6::Zero();
    C.diagonal() << 1e-4, 2e-4, 9e-4, 4e-8, 5e-8, 1e-8;
    C(0, 4) = C(4, 0) = 1e-6;
    const Isometry3d T = some_pose();
    const FrameResult r = calibrate_frame({board("A", nominal, T, C)}, {}, {});
    EXPECT_LT(displacement(T, r.base_from_part).norm(), 1e-9);
    EXPECT_TRUE(r.pass()) << r.faults[0];
    const Matrix6 J = change_of_reference((T * nominal).translation(), T.translation());
    EXPECT_LT((r.covariance - J * C * J.transpose()).norm(), 1e-9 * r.covariance.norm());
    const FrameResult two = calibrate_frame({board("A", nominal, T, C), board("B", nominal, T, C)}, {}, {});
    EXPECT_LT((two.covariance - r.covariance / 2).norm(), 1e-9 * r.covariance.norm());
    EXPECT_EQ(two.redundancy, 6);
}

TEST(CalibrateFrame, TheBoardThatMovedIsNamed) {
    Matrix6 C = Matrix6::Zero();
    C.diagonal() << 1e-4, 1e-4, 1e-4, 1e-8, 1e-8, 1e-8;
    std::vector<FrameFeature> boards;
    for (int i = 0; i < 3; ++i) {
        boards.push_back(
            board("B" + std::to_string(i), Isometry3d(Eigen::Translation3d(200 * i, 30 * i * i, 0)), some_pose(), C));
    }
    boards[2].poses[0].measured.translation() += Vector3d(0, 0.3, 0);
    const FrameResult r = calibrate_frame(boards, {}, {});
    EXPECT_FALSE(r.pass());
    EXPECT_THAT(r.moved, ElementsAre("B2"));
}

TEST(CalibrateFrame, OrderChangesNothing) {
    auto features = points(kFour, some_pose(), 0.02, 7);
    const FrameResult a = calibrate_frame(features, kWork, {});
    std::rotate(features.begin(), features.begin() + 2, features.end());
    const FrameResult b = calibrate_frame(features, kWork, {});
    EXPECT_EQ(a.base_from_part.matrix(), b.base_from_part.matrix());
    EXPECT_EQ(a.covariance, b.covariance);
    EXPECT_EQ(a.work_points[1].expanded_mm, b.work_points[1].expanded_mm);
}

TEST(CalibrateFrame, MovesWithThePart) {
    Isometry3d by = Isometry3d::Identity();
    by.linear() = turn_by({0.4, 0.2, -2.9}).toRotationMatrix();
    by.translation() = Vector3d(-70, 3000, 9);
    auto features = points(kFour, some_pose(), 0.02, 7);
    const FrameResult a = calibrate_frame(features, {}, {});
    for (auto& feature : features) {
        feature.points[0].measured = by * feature.points[0].measured;
    }
    const FrameResult b = calibrate_frame(features, {}, {});
    EXPECT_LT(displacement(by * a.base_from_part, b.base_from_part).norm(), 1e-8);
    EXPECT_NEAR(a.chi_squared, b.chi_squared, 1e-6);
}

// Centres of balls of 12.7 mm, each from 2000 points with 0.03 mm of noise, have a 1-sigma of 0.0013 mm across the line
// of sight.
TEST(CalibrateFrame, NamesTheBallThatMoved) {
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal;
    int named = 0;
    for (int seed = 1; seed <= 100; ++seed) {
        auto features = points(kFour, some_pose(), 0.0013, static_cast<std::uint64_t>(seed));
        const std::size_t which = static_cast<std::size_t>(seed) % 4;
        features[which].points[0].measured +=
            0.2 * Vector3d(normal(random), normal(random), normal(random)).normalized();
        const FrameResult r = calibrate_frame(features, {}, {});
        named += r.moved == std::vector<std::string>{features[which].name};
        EXPECT_FALSE(r.pass());
    }
    EXPECT_GE(named, 99);
}

// Balls in one plane can't tell which of them left it.
TEST(CalibrateFrame, SaysWhenItCanNotTellWhichMoved) {
    auto features = points({{0, 0, 0}, {400, 0, 0}, {370, 290, 0}, {40, 240, 0}}, some_pose(), 0.003, 3);
    features[1].points[0].measured += 0.2 * some_pose().linear().col(2);
    const FrameResult r = calibrate_frame(features, kWork, {});
    EXPECT_EQ(r.moved.size(), 4u);
    EXPECT_FALSE(r.pass());
}

TEST(CalibrateFrame, PointsOnALineLeaveATurnOpen) {
    const auto features = points({{0, 0, 0}, {100, 0, 0}, {250, 0, 0}, {400, 0, 0}}, some_pose(), 0.01);
    const FrameResult refused = calibrate_frame(features, kWork, {});
    ASSERT_EQ(refused.weak.size(), 1u);
    EXPECT_TRUE(refused.weak[0].turn);
    EXPECT_THAT(refused.weak[0].text, HasSubstr("turn about (1.000, 0.000, 0.000) through"));
    EXPECT_FALSE(refused.pass());
    FrameOptions freeze;
    freeze.weak = WeakDirection::freeze;
    const FrameResult frozen = calibrate_frame(features, {{"on the line", {50, 0, 0}}}, freeze);
    EXPECT_TRUE(frozen.pass());
    EXPECT_THAT(frozen.notes[0], HasSubstr("kept as at the start"));
}

TEST(CalibrateFrame, CheckPointsAreHeldAgainstTheirOwnUncertainty) {
    std::vector<FramePoint> measured;
    for (const auto& p : kFour) {
        measured.push_back({p, some_pose() * p, 1e-4 * Matrix3d::Identity()});
    }
    const std::vector<std::string> names{"O", "X", "XY", "check"};
    const FrameResult good =
        calibrate_frame(three_point_features(names, measured), kWork, {},
                        rigid_through(kFour, std::vector<Vector3d>{measured[0].measured, measured[1].measured,
                                                                   measured[2].measured, measured[3].measured}));
    EXPECT_LT(displacement(some_pose(), good.base_from_part).norm(), 1e-8);
    EXPECT_EQ(good.redundancy, 0);
    EXPECT_TRUE(good.pass()) << good.faults[0];
    measured[3].measured += Vector3d(0, 0, 0.3);
    const FrameResult bad = calibrate_frame(three_point_features(names, measured), kWork, {}, some_pose());
    ASSERT_FALSE(bad.pass());
    EXPECT_THAT(bad.faults[0], HasSubstr("check point check is off by 0.300 mm"));
    EXPECT_LT(displacement(good.base_from_part, bad.base_from_part).norm(), 1e-9);
}

// The textbook's construction, with points that are not exactly where they should be.
TEST(CalibrateFrame, ThreePointsAreTheTextbooksFrame) {
    const std::vector<Vector3d> nominal{{0, 0, 0}, {300, 0, 0}, {50, 200, 0}};
    const Vector3d p1(10, 20, 30), p2(290, 60, 25), p3(40, 230, 70);
    std::vector<FramePoint> measured;
    for (const auto& [q, p] : {std::pair{nominal[0], p1}, {nominal[1], p2}, {nominal[2], p3}}) {
        measured.push_back({q, p, 1e-4 * Matrix3d::Identity()});
    }
    const FrameResult r = calibrate_frame(three_point_features({"1", "2", "3"}, measured), {}, {},
                                          rigid_through(nominal, std::vector<Vector3d>{p1, p2, p3}));
    const Vector3d X = (p2 - p1).normalized(), Z = X.cross(p3 - p1).normalized();
    EXPECT_LT((r.base_from_part.translation() - p1).norm(), 1e-9);
    EXPECT_LT((r.base_from_part.linear().col(0) - X).norm(), 1e-10);
    EXPECT_LT((r.base_from_part.linear().col(2) - Z).norm(), 1e-10);
}

std::vector<DatumPlane> corner(const Isometry3d& T, double square_error) {
    const auto touch = [&](const Vector3d& q) { return TouchedPoint{q, T * q, 0.005}; };
    DatumPlane A{"A", {0, 0, 1}, 0, {touch({0, 0, 0}), touch({300, 10, 0}), touch({150, 200, 0}), touch({20, 180, 0})}};
    DatumPlane B{"B", {0, 1, 0}, 0, {}};
    for (const auto& q : {Vector3d(20, 0, 10), Vector3d(280, 0, 40)}) {
        B.touched.push_back(touch(q));
        B.touched.back().measured = T * (q + Vector3d(0, square_error * q.z(), 0));
    }
    DatumPlane C{"C", {1, 0, 0}, 0, {touch({0, 60, 20})}};
    return {A, B, C};
}

TEST(CalibratePlanes, ExactPointsGiveTheirFrame) {
    const FrameResult r = calibrate_planes(corner(some_pose(), 0), kWork, {});
    EXPECT_LT(displacement(some_pose(), r.base_from_part).norm(), 1e-9);
    EXPECT_EQ(r.redundancy, 1);
    EXPECT_TRUE(r.pass()) << r.faults[0];
}

// Plane B leans; by precedence A keeps its plane all the same.
TEST(CalibratePlanes, TheFirstDatumTakesPrecedence) {
    const FrameResult r = calibrate_planes(corner(some_pose(), 0.01), kWork, {});
    EXPECT_LT((r.base_from_part.linear().col(2) - some_pose().linear().col(2)).norm(), 1e-12);
    EXPECT_LT(r.features[0].residual_mm, 1e-9);
    EXPECT_LT(r.features[1].residual_mm, 1e-9);
}

TEST(CalibratePlanes, UncertaintyIsWhatRepeatedMeasurementsShow) {
    std::mt19937_64 random(11);
    std::normal_distribution<double> normal;
    int inside = 0;
    constexpr int kSets = 1000;
    for (int set = 0; set < kSets; ++set) {
        auto planes = corner(some_pose(), 0);
        for (auto& plane : planes) {
            for (auto& t : plane.touched) {
                t.measured += t.sigma_mm * Vector3d(normal(random), normal(random), normal(random));
            }
        }
        const FrameResult r = calibrate_planes(planes, {}, {});
        const Vector6 d = displacement(r.base_from_part, some_pose());
        inside += d.dot(r.covariance.ldlt().solve(d)) < 12.592;
    }
    EXPECT_GE(inside, 0.93 * kSets);
    EXPECT_LE(inside, 0.97 * kSets);
}

TEST(CalibrateInput, IsRefusedInOneLine) {
    const auto message = [](const auto& f) -> std::string {
        try {
            f();
        } catch (const InputError& e) {
            return e.what();
        }
        return "";
    };
    EXPECT_THAT(message([] { calibrate_frame({}, {}, {}); }), HasSubstr("there is no feature"));
    EXPECT_THAT(message([] {
                    calibrate_frame(points({{0, 0, 0}, {1, 0, 0}}, some_pose(), 0.01), {}, {});
                }),
                HasSubstr("2 points are too few"));
    EXPECT_THAT(message([] { calibrate_frame(points(kFour, some_pose(), 0), {}, {}); }),
                HasSubstr("not positive definite"));
    auto planes = corner(some_pose(), 0);
    planes[1].touched.pop_back();
    EXPECT_THAT(message([&] { calibrate_planes(planes, {}, {}); }), HasSubstr("plane B has 1 points; at least 2"));
    planes[2].normal = {0, 0.01, 1};
    EXPECT_THAT(message([&] { calibrate_planes(planes, {}, {}); }), HasSubstr("do not stand across"));
}

}  // namespace frame_test
}  // namespace seampath
