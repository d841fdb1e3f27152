#include "stages/robot_frames/robot_frames.hpp"

#include <Eigen/Dense>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/fixtures/robot_scenes.hpp"
#include "stages/angle.hpp"
#include "stages/error.hpp"

/// Tools and sensors on made robots against their truth.
namespace seampath {
namespace robot_frames_test {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;

PoseNoise no_noise() {
    return {1e-9, 1e-12, 1e-9, 1e-12};
}

/// Errors over seeds.
struct Tally {
    double squares_mm = 0, squares_rad = 0, at_work = 0, largest_mm = 0;
    int sets = 0, inside = 0, named = 0;

    void add(const RobotFrame& r, const Isometry3d& truth, Eigen::Index of_frame, double region) {
        const Vector6 d = displacement(truth, r.frame);
        const Eigen::VectorXd e = d.head(of_frame);
        const Eigen::MatrixXd C = r.covariance.topLeftCorner(of_frame, of_frame);
        squares_mm += d.head<3>().squaredNorm();
        squares_rad += d.tail<3>().squaredNorm();
        at_work += (r.frame * r.work_point - truth * r.work_point).squaredNorm();
        largest_mm = std::max(largest_mm, d.head<3>().norm());
        inside += e.dot(C.ldlt().solve(e)) < region;
        ++sets;
    }
    double rms_mm() const { return std::sqrt(squares_mm / sets); }
    double work_rms_mm() const { return std::sqrt(at_work / sets); }
    double rms_deg() const { return std::sqrt(squares_rad / sets) / kDegree; }
};

std::vector<std::string> left_out(const RobotFrame& r) {
    std::vector<std::string> names;
    for (const PoseResult& pose : r.poses) {
        if (pose.left_out) {
            names.push_back(pose.name);
        }
    }
    return names;
}

template <class F>
std::string error_of(const F& f) {
    try {
        f();
        return "";
    } catch (const InputError& error) {
        return error.what();
    }
}

TEST(Tcp, ExactPosesGiveTheTip) {
    RobotScene scene;
    scene.noise = no_noise();
    const TipPoses made = make_tip_poses(scene, 1);
    const RobotFrame r = calibrate_tcp(made.poses, {});
    EXPECT_LT((r.frame.translation() - made.truth.frame.translation()).norm(), 1e-6);
    EXPECT_LT((r.target.translation() - made.truth.target.translation()).norm(), 1e-6);
    EXPECT_TRUE(r.pass());
    EXPECT_EQ(r.redundancy, 39);
}

// The normal equations in closed form: with M the mean of the rotations, the tip's information is n (I - M'M) / s^2.
TEST(Tcp, CovarianceIsTheClosedForm) {
    const TipPoses made = make_tip_poses({}, 2);
    const RobotFrame r = calibrate_tcp(made.poses, {});
    Eigen::Matrix3d M = Eigen::Matrix3d::Zero();
    double squares = 0;
    for (const FlangePose& pose : made.poses) {
        M += pose.base_from_flange.linear() / 15;
        squares += (pose.base_from_flange * r.frame.translation() - r.target.translation()).squaredNorm();
    }
    const Eigen::Matrix3d C = squares / 39 * (15 * (Eigen::Matrix3d::Identity() - M.transpose() * M)).inverse();
    const Eigen::Matrix3d found = r.covariance.topLeftCorner<3, 3>();
    EXPECT_LT((found - C).norm(), 1e-6 * C.norm());
    EXPECT_NEAR(r.weakest_mm * r.weakest_mm, C.eigenvalues().real().maxCoeff(), 1e-6 * C.norm());
}

TEST(Tcp, SigmaIsTrueAndTheRegionHolds) {
    Tally tally;
    RobotScene scene;
    scene.noise.robot_rad = 1e-9;  // the model of a pivot: errors of place
    double stated = 0;
    for (std::uint64_t seed = 1; seed <= 400; ++seed) {
        const TipPoses made = make_tip_poses(scene, seed);
        const RobotFrame r = calibrate_tcp(made.poses, {});
        tally.add(r, made.truth.frame, 3, 3 * 2.85);  // F(3, 39) at 95 %
        stated += r.covariance.trace() / 400;
    }
    EXPECT_NEAR(tally.rms_mm() / std::sqrt(stated), 1, 0.1);
    EXPECT_GE(tally.inside, 368);
    EXPECT_LE(tally.inside, 392);
}

TEST(Tcp, TheOrderOfThePosesChangesNothing) {
    TipPoses made = make_tip_poses({}, 3);
    const RobotFrame a = calibrate_tcp(made.poses, {});
    std::reverse(made.poses.begin(), made.poses.end());
    EXPECT_LT((calibrate_tcp(made.poses, {}).frame.translation() - a.frame.translation()).norm(), 1e-9);
}

TEST(Tcp, ThePoseThatSlippedIsNamedAndLeftOut) {
    int named = 0, false_alarms = 0;
    for (std::uint64_t seed = 1; seed <= 100; ++seed) {
        RobotScene scene;
        scene.noise.robot_rad = 1e-9;
        false_alarms += !left_out(calibrate_tcp(make_tip_poses(scene, seed).poses, {})).empty();
        scene.moved = static_cast<int>(seed % 15);
        const RobotFrame r = calibrate_tcp(make_tip_poses(scene, seed).poses, {});
        named += left_out(r) == std::vector<std::string>{"pose " + std::to_string(scene.moved + 1)};
    }
    EXPECT_GE(named, 97);
    EXPECT_LE(false_alarms, 4);
}

TEST(Tcp, TurnsAboutOneAxisAreRefusedByName) {
    RobotScene scene;
    scene.one_axis = true;
    EXPECT_THAT(error_of([&] { calibrate_tcp(make_tip_poses(scene, 1).poses, {}); }),
                AllOf(HasSubstr("all poses turn about one axis"), HasSubstr("1.000) of the flange")));
    scene.spread_rad = 0;
    EXPECT_THAT(error_of([&] { calibrate_tcp(make_tip_poses(scene, 1).poses, {}); }),
                HasSubstr("the poses do not turn"));
    EXPECT_THAT(error_of([&] { calibrate_tcp({}, {}); }), HasSubstr("0 poses are too few"));
}

TEST(CameraMount, ExactPosesGiveTheFrameOnAndBesideTheArm) {
    for (const SensorMount mount : {SensorMount::on_arm, SensorMount::beside_arm}) {
        RobotScene scene;
        scene.noise = no_noise();
        scene.mount = mount;
        const BoardPoses made = make_board_poses(scene, 4);
        const RobotFrame r = calibrate_camera_mount(made.poses, mount, {});
        EXPECT_LT(displacement(made.truth.frame, r.frame).norm(), 1e-6);
        EXPECT_LT(displacement(made.truth.target, r.target).norm(), 1e-6);
        EXPECT_TRUE(r.pass());
    }
}

TEST(CameraMount, FifteenPosesReachTheNoiseInThousandSets) {
    for (const SensorMount mount : {SensorMount::on_arm, SensorMount::beside_arm}) {
        Tally tally;
        const int sets = mount == SensorMount::on_arm ? 1000 : 300;
        for (int seed = 1; seed <= sets; ++seed) {
            RobotScene scene;
            scene.mount = mount;
            const BoardPoses made = make_board_poses(scene, static_cast<std::uint64_t>(seed));
            tally.add(calibrate_camera_mount(made.poses, mount, {}), made.truth.frame, 6, 6 * 2.22);  // F(6, 78), 95 %
        }
        std::cout << "rms " << tally.rms_mm() << " mm, at the work point " << tally.work_rms_mm() << " mm, "
                  << tally.rms_deg() << " deg; largest " << tally.largest_mm
                  << " mm; in the 95 % region: " << tally.inside << " of " << tally.sets << "\n";
        EXPECT_LE(tally.rms_mm(), 0.15);
        EXPECT_LE(tally.rms_deg(), 0.03);
        EXPECT_LE(tally.largest_mm, 1);
        EXPECT_NEAR(tally.inside, 0.95 * sets, 3 * std::sqrt(0.95 * 0.05 * sets));  // of a binomial distribution
    }
}

TEST(CameraMount, ThePoseInWhichTheBoardMovedIsNamed) {
    int named = 0;
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
        RobotScene scene;
        scene.moved = static_cast<int>(seed % 15);
        scene.moved_mm = 2;
        const RobotFrame r = calibrate_camera_mount(make_board_poses(scene, seed).poses, scene.mount, {});
        named += left_out(r) == std::vector<std::string>{"pose " + std::to_string(scene.moved + 1)};
    }
    EXPECT_GE(named, 48);
}

TEST(CameraMount, DegenerateMotionsAreNamed) {
    RobotScene scene;
    scene.one_axis = true;
    EXPECT_THAT(error_of([&] { calibrate_camera_mount(make_board_poses(scene, 1).poses, scene.mount, {}); }),
                HasSubstr("all poses turn about one axis, (0.000, 0.000, 1.000) of the flange"));
    // Small turns are no error of the input, but their result does not pass, and says why.
    scene.one_axis = false;
    scene.spread_rad = 0.02;
    const RobotFrame r = calibrate_camera_mount(make_board_poses(scene, 1).poses, scene.mount, {});
    ASSERT_FALSE(r.pass());
    EXPECT_THAT(r.faults.back(), HasSubstr("add poses that turn more"));
}

TEST(ProfilerMount, ExactSectionsGiveTheFrame) {
    for (const SensorMount mount : {SensorMount::on_arm, SensorMount::beside_arm}) {
        RobotScene scene;
        scene.noise = no_noise();
        scene.mount = mount;
        BallSweep sweep;
        sweep.sigma_mm = 1e-7;
        const BallProfiles made = make_ball_profiles(scene, sweep, 5);
        const RobotFrame r = calibrate_profiler_mount(made.profiles, sweep.diameter_mm / 2, mount, {});
        EXPECT_LT(displacement(made.truth.frame, r.frame).norm(), 1e-4);
        EXPECT_LT((made.truth.target.translation() - r.target.translation()).norm(), 1e-4);
    }
}

TEST(ProfilerMount, ABallInManySectionsGivesATenthOfAMillimetre) {
    Tally tally;
    RobotScene scene;
    scene.poses = 20;
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
        const BallProfiles made = make_ball_profiles(scene, {}, seed);
        const RobotFrame r = calibrate_profiler_mount(made.profiles, 12.7, SensorMount::on_arm, {});
        tally.add(r, made.truth.frame, 6, 6 * 2.15);  // F(6, 231), 95 %
    }
    std::cout << "rms " << tally.rms_mm() << " mm, at the work point " << tally.work_rms_mm() << " mm, "
              << tally.rms_deg() << " deg; largest " << tally.largest_mm << " mm; in the 95 % region: " << tally.inside
              << " of 50\n";
    EXPECT_LE(tally.rms_mm(), 0.1);
    EXPECT_GE(tally.inside, 43);
}

TEST(ProfilerMount, BadSectionsAreNamed) {
    const auto profiles = make_ball_profiles({}, {}, 1).profiles;
    const auto error = [](const std::vector<BallProfile>& given, double radius = 12.7) {
        return error_of([&] { calibrate_profiler_mount(given, radius, SensorMount::on_arm, {}); });
    };
    EXPECT_THAT(error(profiles, 8), HasSubstr("is larger than the ball's 8 mm; check the ball's diameter"));
    EXPECT_THAT(error({profiles.begin(), profiles.begin() + 5}), HasSubstr("5 sections of the ball are too few"));
    auto bad = profiles;
    bad[3].points.resize(4);
    EXPECT_THAT(error(bad), HasSubstr("pose 4: 4 points are too few"));
    bad = profiles;
    for (Eigen::Vector2d& p : bad[7].points) {
        p.y() = 100 + 0.1 * p.x() + 0.03 * std::sin(1000 * p.x());
    }
    EXPECT_THAT(error(bad), HasSubstr("pose 8"));
    RobotScene scene;
    scene.one_axis = true;
    EXPECT_THAT(error(make_ball_profiles(scene, {}, 1).profiles), HasSubstr("all poses turn about one axis"));
    scene.one_axis = false;
    scene.moved = 11;
    scene.moved_mm = 2;
    const RobotFrame r =
        calibrate_profiler_mount(make_ball_profiles(scene, {}, 1).profiles, 12.7, SensorMount::on_arm, {});
    EXPECT_EQ(left_out(r), std::vector<std::string>{"pose 12"});
}

}  // namespace robot_frames_test
}  // namespace seampath
