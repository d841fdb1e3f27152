#include <cmath>

#include <Eigen/Dense>

#include "stages/error.hpp"
#include "stages/geometry/pose.hpp"
#include "stages/robot_frames/poses.hpp"
#include "stages/robot_frames/robot_frames.hpp"

namespace seampath {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr std::size_t kLeastBoards = 4;

/// Of one pose, A and B of A X B = Y.
struct Motion {
    Isometry3d A, B;
};

/// Park and Martin: with the rotation vectors a and b of every relative motion, a = R b, so R is the rotation nearest
/// to sum a b' (their (M'M)^-1/2 M' with M = sum b a', eq. 4.12, made proper); then (R_A - I) t = R t_B - t_A.
Isometry3d park_martin(const std::vector<Motion>& motions) {
    constexpr double kTwoWays = 3.0;  // rad; the axis of a half turn has two directions
    Matrix3d M = Matrix3d::Zero();
    std::vector<Motion> pairs;
    for (std::size_t i = 0; i < motions.size(); ++i) {
        for (std::size_t k = i + 1; k < motions.size(); ++k) {
            const Motion pair{motions[k].A.inverse() * motions[i].A, motions[k].B * motions[i].B.inverse()};
            const Vector3d a = rotation_vector(Quaterniond(pair.A.linear()));
            const Vector3d b = rotation_vector(Quaterniond(pair.B.linear()));
            if (a.norm() < kTwoWays && b.norm() < kTwoWays) {
                M += a * b.transpose();
            }
            pairs.push_back(pair);
        }
    }
    Isometry3d X = Isometry3d::Identity();
    X.linear() = nearest_rotation(M);
    Matrix3d H = Matrix3d::Zero();
    Vector3d g = Vector3d::Zero();
    for (const Motion& pair : pairs) {
        const Matrix3d J = pair.A.linear() - Matrix3d::Identity();
        H += J.transpose() * J;
        g += J.transpose() * (X.linear() * pair.B.translation() - pair.A.translation());
    }
    X.translation() = MatrixXd(H).ldlt().solve(g);
    return X;
}

/// The board from all poses alike.
Isometry3d mean_target(const std::vector<Motion>& motions, const Isometry3d& X) {
    Matrix3d turn = Matrix3d::Zero();
    Isometry3d Y = Isometry3d::Identity();
    for (const Motion& motion : motions) {
        const Isometry3d seen = motion.A * X * motion.B;
        turn += seen.linear();
        Y.translation() += seen.translation() / static_cast<double>(motions.size());
    }
    Y.linear() = nearest_rotation(turn);
    return Y;
}

/// Covariance of displacement(Y, A X B): shifts and turns of the robot's flange and of the board in the camera. A turn
/// of the arm moves the board by the lever from the frame that turns. Beside the arm, A is the inverse of the robot's
/// pose, which turns about the flange, where the board is.
Matrix6 noise_of(const Motion& motion, const Isometry3d& X, SensorMount mount, const PoseNoise& noise) {
    const Vector3d board = motion.A * (X * motion.B.translation());
    const Vector3d lever = mount == SensorMount::on_arm ? Vector3d(board - motion.A.translation()) : board;
    const Matrix3d L = cross_matrix(lever);
    const double turn = noise.robot_rad * noise.robot_rad;
    Matrix6 C = Matrix6::Zero();
    C.topLeftCorner<3, 3>() =
        (noise.robot_mm * noise.robot_mm + noise.sensor_mm * noise.sensor_mm) * Matrix3d::Identity() - turn * L * L;
    C.topRightCorner<3, 3>() = -turn * L;
    C.bottomLeftCorner<3, 3>() = turn * L;
    C.bottomRightCorner<3, 3>() = (turn + noise.sensor_rad * noise.sensor_rad) * Matrix3d::Identity();
    return C;
}

/// X and Y about which the shared parameters are steps, and what whitens each residual.
struct MountFit {
    std::vector<Motion> motions;
    std::vector<Eigen::LLT<MatrixXd>> noise;
    Isometry3d X, Y;

    Vector6 error(std::size_t i, const VectorXd& step) const {
        const Isometry3d moved_X = displaced(X, step.head<6>(), X.translation());
        const Isometry3d moved_Y = displaced(Y, step.tail<6>(), Y.translation());
        return displacement(moved_Y, motions[i].A * moved_X * motions[i].B);
    }

    BlockFit fit(const std::vector<std::size_t>& kept) const {
        BlockProblem problem;
        problem.blocks = kept.size();
        problem.shared_unit = VectorXd::Constant(12, 1e-2);                                            // mm
        problem.shared_unit.segment<3>(3) = problem.shared_unit.tail<3>() = Vector3d::Constant(1e-5);  // rad
        problem.residuals = [&](std::size_t k, const VectorXd& step, const VectorXd&) {
            return VectorXd(noise[kept[k]].matrixL().solve(VectorXd(error(kept[k], step))));
        };
        return fit_blocks(problem, VectorXd::Zero(12), std::vector<VectorXd>(kept.size()));
    }
};

}  // namespace

RobotFrame calibrate_camera_mount(const std::vector<BoardPose>& poses, SensorMount mount,
                                  const RobotFrameOptions& options) {
    if (poses.size() < kLeastBoards) {
        throw InputError("hand-eye: " + std::to_string(poses.size()) +
                         " poses are too few; at least 4, better 15, in different orientations were needed");
    }
    MountFit mounted;
    std::vector<Isometry3d> turns;
    std::vector<std::string> names;
    for (const BoardPose& pose : poses) {
        const Isometry3d& A = pose.flange.base_from_flange;
        mounted.motions.push_back({mount == SensorMount::on_arm ? A : A.inverse(), pose.camera_from_board});
        turns.push_back(mounted.motions.back().A);
        names.push_back(pose.flange.name);
    }
    robot_frames::require_turns(turns, "hand-eye", mount == SensorMount::on_arm ? "the flange" : "the base");
    mounted.X = park_martin(mounted.motions);
    mounted.Y = mean_target(mounted.motions, mounted.X);
    for (const Motion& motion : mounted.motions) {
        mounted.noise.emplace_back(MatrixXd(noise_of(motion, mounted.X, mount, options.noise)));
    }
    const robot_frames::RobustFit robust = robot_frames::fit_without_outliers(
        poses.size(), kLeastBoards, [&](const std::vector<std::size_t>& kept) { return mounted.fit(kept); });
    RobotFrame result;
    result.frame = displaced(mounted.X, robust.fit.shared.head<6>(), mounted.X.translation());
    result.target = displaced(mounted.Y, robust.fit.shared.tail<6>(), mounted.Y.translation());
    std::vector<double> mm, rad;
    result.work_point = Vector3d::Zero();
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const Vector6 error = mounted.error(i, robust.fit.shared);
        mm.push_back(error.head<3>().norm());
        rad.push_back(error.tail<3>().norm());
        result.work_point += poses[i].camera_from_board.translation() / static_cast<double>(poses.size());
    }
    robot_frames::add_residuals(names, robust, mm, rad, result);
    robot_frames::judge_fit(robust, 6, options, result);
    return result;
}

}  // namespace seampath
