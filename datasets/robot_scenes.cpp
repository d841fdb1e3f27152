#include "datasets/robot_scenes.hpp"

#include <cmath>

#include "datasets/fixture_draws.hpp"

namespace seampath {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

enum RobotStream : std::uint64_t { kRobotTruth = 950, kRobotPoses, kRobotNoise, kRobotMoved, kRobotPoints };

Isometry3d shifted(const Vector3d& by) {
    return Isometry3d(Eigen::Translation3d(by));
}

Isometry3d orientation(const RobotScene& scene, Draws& draws) {
    const double s = scene.spread_rad;
    const double x = draws.uniform(-s, s), y = draws.uniform(-s, s), z = draws.uniform(-s, s);
    Isometry3d T = Isometry3d::Identity();
    T.linear() = turn_by(scene.one_axis ? Vector3d(0, 0, z) : Vector3d(x, y, z)).toRotationMatrix();
    return T;
}

/// Tool or sensor some 100 to 200 mm from the flange, or anywhere in the base.
RobotTruth truth_of(SensorMount mount, std::uint64_t seed) {
    Draws draws(seed, kRobotTruth);
    RobotTruth truth{draws.pose(mount == SensorMount::on_arm ? 150 : 1000), draws.pose(1000)};
    if (mount == SensorMount::beside_arm) {
        truth.target.translation() *= 0.15;
    }
    return truth;
}

Isometry3d with_noise(const Isometry3d& T, double mm, double rad, Draws& draws) {
    Vector6 step;
    for (int i = 0; i < 6; ++i) {
        step[i] = (i < 3 ? mm : rad) * draws.normal();
    }
    return displaced(T, step, T.translation());
}

/// A of A X B = Y, as the robot reports it.
FlangePose as_reported(const Isometry3d& A, const RobotScene& scene, int index, Draws& draws) {
    const Isometry3d base_from_flange = scene.mount == SensorMount::on_arm ? A : A.inverse();
    return {"pose " + std::to_string(index + 1),
            with_noise(base_from_flange, scene.noise.robot_mm, scene.noise.robot_rad, draws)};
}

Isometry3d moved_by(const RobotScene& scene, int index, Draws& draws) {
    return index == scene.moved ? shifted(scene.moved_mm * draws.direction()) : Isometry3d::Identity();
}

}  // namespace

TipPoses make_tip_poses(const RobotScene& scene, std::uint64_t seed) {
    Draws posing(seed, kRobotPoses), noise(seed, kRobotNoise), moving(seed, kRobotMoved);
    TipPoses made{truth_of(SensorMount::on_arm, seed), {}};
    made.truth.frame.linear().setIdentity();
    made.truth.target.linear().setIdentity();
    for (int i = 0; i < scene.poses; ++i) {
        Isometry3d A = orientation(scene, posing);
        A.translation() =
            moved_by(scene, i, moving) * made.truth.target.translation() - A.linear() * made.truth.frame.translation();
        made.poses.push_back(as_reported(A, scene, i, noise));
    }
    return made;
}

BoardPoses make_board_poses(const RobotScene& scene, std::uint64_t seed) {
    Draws posing(seed, kRobotPoses), noise(seed, kRobotNoise), moving(seed, kRobotMoved);
    BoardPoses made{truth_of(scene.mount, seed), {}};
    for (int i = 0; i < scene.poses; ++i) {
        // With all turns about one axis of the flange, A X B = Y is solved for B.
        const Vector3d at(posing.uniform(-60, 60), posing.uniform(-60, 60), posing.uniform(240, 360));
        Isometry3d B = shifted(at) * orientation(scene, posing);
        Isometry3d A = made.truth.target * (made.truth.frame * B).inverse();
        if (scene.one_axis) {
            A = shifted(at) * orientation(scene, posing);
            B = (A * made.truth.frame).inverse() * made.truth.target;
        }
        B = B * moved_by(scene, i, moving);
        made.poses.push_back(
            {as_reported(A, scene, i, noise), with_noise(B, scene.noise.sensor_mm, scene.noise.sensor_rad, noise)});
    }
    return made;
}

BallProfiles make_ball_profiles(const RobotScene& scene, const BallSweep& sweep, std::uint64_t seed) {
    Draws posing(seed, kRobotPoses), noise(seed, kRobotNoise), moving(seed, kRobotMoved), points(seed, kRobotPoints);
    BallProfiles made{truth_of(scene.mount, seed), {}};
    made.truth.target.linear().setIdentity();
    const double R = sweep.diameter_mm / 2;
    Isometry3d base = Isometry3d::Identity();
    for (int i = 0; i < scene.poses * sweep.sections; ++i) {
        const double far = sweep.off_centre * R;
        const Vector3d b(posing.uniform(-40, 40), posing.uniform(-far, far), posing.uniform(110, 190));
        base = i % sweep.sections == 0 ? orientation(scene, posing) : base;
        Isometry3d A = base * shifted(-b) * made.truth.frame.inverse();
        A.translation() += moved_by(scene, i, moving) * made.truth.target.translation();
        BallProfile profile{as_reported(A, scene, i, noise), {}};
        const double rho = std::sqrt(R * R - b.y() * b.y());
        for (int k = 0; k < sweep.points; ++k) {
            const double a = points.uniform(-sweep.arc_rad, sweep.arc_rad);
            profile.points.emplace_back(b.x() + rho * portable::sin(a),
                                        b.z() - rho * portable::cos(a) + sweep.sigma_mm * points.normal());
        }
        made.profiles.push_back(std::move(profile));
    }
    return made;
}

}  // namespace seampath
