#include <cmath>

#include <Eigen/Dense>

#include "stages/error.hpp"
#include "stages/robot_frames/poses.hpp"
#include "stages/robot_frames/robot_frames.hpp"
#include "stages/robot_frames/sections.hpp"

namespace seampath {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using robot_frames::BallSection;

constexpr std::size_t kLeastSections = 6;

/// Sections and the poses A (base_from_flange, or its inverse beside the arm) in which they were measured: the ball's
/// centre b in the sensor's frame goes to A X b = c in all of them.
struct BallFit {
    std::vector<Isometry3d> A;
    std::vector<BallSection> sections;
    double radius = 0;
    PoseNoise noise;
    SensorMount mount = SensorMount::on_arm;
    Isometry3d X = Isometry3d::Identity();
    Vector3d c{0, 0, 0};

    Vector3d centre_in_sensor(std::size_t i) const { return X.inverse() * (A[i].inverse() * c); }

    /// Linear least squares of A (x e_x + y e_y + z e_z + t) - c = 0 in the sensor's axes e, t and c. Without the
    /// distances y off the laser's plane, e_y is what the other two leave.
    void solve_linear(const VectorXd& off_plane);

    /// Off the section's circle: its centre's two numbers, and |y, rho| - R.
    Vector3d error(std::size_t i, const VectorXd& step) const {
        const Isometry3d moved = displaced(X, step.head<6>(), X.translation());
        const Vector3d b = moved.inverse() * (A[i].inverse() * (c + step.tail<3>()));
        const BallSection& s = sections[i];
        return {s.centre.x() - b.x(), s.centre.y() - b.z(), std::hypot(b.y(), s.radius) - radius};
    }

    /// Lower triangle that whitens it, as X and c stand: noise of the points and shifts of the ball as the robot sees
    /// it.
    Matrix3d noise_factor(std::size_t i) const;

    BlockFit fit(const std::vector<std::size_t>& kept) const;

    /// Takes over a fit's parameters.
    void move(const VectorXd& step) {
        X = displaced(X, step.head<6>(), X.translation());
        c += step.tail<3>();
    }
};

void BallFit::solve_linear(const VectorXd& off_plane) {
    const bool known = off_plane.size() > 0;
    const Eigen::Index axes = known ? 9 : 6, size = axes + 6;
    MatrixXd H = MatrixXd::Zero(size, size);
    VectorXd g = VectorXd::Zero(size);
    for (std::size_t i = 0; i < A.size(); ++i) {
        MatrixXd J = MatrixXd::Zero(3, size);
        const Matrix3d R = A[i].linear();
        J.leftCols<3>() = sections[i].centre.x() * R;
        J.middleCols<3>(3) = sections[i].centre.y() * R;
        if (known) {
            J.middleCols<3>(6) = off_plane[static_cast<Eigen::Index>(i)] * R;
        }
        J.middleCols<3>(axes) = R;
        J.rightCols<3>() = -Matrix3d::Identity();
        H += J.transpose() * J;
        g -= J.transpose() * A[i].translation();
    }
    const VectorXd x = H.completeOrthogonalDecomposition().solve(g);
    Matrix3d E;
    E.col(0) = x.head<3>();
    E.col(2) = x.segment<3>(3);
    E.col(1) = known ? Vector3d(x.segment<3>(6)) : Vector3d(E.col(2).cross(E.col(0)));
    X.linear() = nearest_rotation(E);
    X.translation() = x.segment<3>(axes);
    c = x.tail<3>();
}

Matrix3d BallFit::noise_factor(std::size_t i) const {
    const Vector3d b = centre_in_sensor(i);
    const BallSection& s = sections[i];
    const Vector3d in_moving = A[i].inverse() * c;
    const double lever = mount == SensorMount::on_arm ? in_moving.norm() : c.norm();
    const double shift = noise.robot_mm * noise.robot_mm + noise.robot_rad * noise.robot_rad * lever * lever;
    const double length = std::hypot(b.y(), s.radius);
    Matrix3d C = s.covariance;
    C.row(2) *= s.radius / length;
    C.col(2) *= s.radius / length;
    C += Vector3d(shift, shift, shift * std::pow(b.y() / length, 2)).asDiagonal();
    return C.llt().matrixL();
}

BlockFit BallFit::fit(const std::vector<std::size_t>& kept) const {
    std::vector<Matrix3d> factor;
    for (const std::size_t i : kept) {
        factor.push_back(noise_factor(i));
    }
    BlockProblem problem;
    problem.blocks = kept.size();
    problem.shared_unit = VectorXd::Constant(9, 1e-2);             // mm
    problem.shared_unit.segment<3>(3) = Vector3d::Constant(1e-5);  // rad
    problem.residuals = [&](std::size_t k, const VectorXd& step, const VectorXd&) {
        return VectorXd(factor[k].triangularView<Eigen::Lower>().solve(error(kept[k], step)));
    };
    return fit_blocks(problem, VectorXd::Zero(9), std::vector<VectorXd>(kept.size()));
}

/// On which side of the laser's plane the ball is, and how far, as the frame found so far has it.
VectorXd off_plane_of(const BallFit& ball) {
    VectorXd y(static_cast<Eigen::Index>(ball.A.size()));
    for (std::size_t i = 0; i < ball.A.size(); ++i) {
        const double rho = std::min(ball.sections[i].radius, ball.radius);
        y[static_cast<Eigen::Index>(i)] =
            std::copysign(std::sqrt(ball.radius * ball.radius - rho * rho), ball.centre_in_sensor(i).y());
    }
    return y;
}

}  // namespace

RobotFrame calibrate_profiler_mount(const std::vector<BallProfile>& profiles, double radius_mm, SensorMount mount,
                                    const RobotFrameOptions& options) {
    if (profiles.size() < kLeastSections) {
        throw InputError("profiler: " + std::to_string(profiles.size()) +
                         " sections of the ball are too few; at least 6, better 40, in different orientations were "
                         "needed");
    }
    BallFit ball;
    ball.radius = radius_mm;
    ball.noise = options.noise;
    ball.mount = mount;
    std::vector<std::string> names;
    for (const BallProfile& profile : profiles) {
        const Isometry3d& A = profile.flange.base_from_flange;
        ball.A.push_back(mount == SensorMount::on_arm ? A : A.inverse());
        ball.sections.push_back(robot_frames::section_of(profile, radius_mm));
        names.push_back(profile.flange.name);
    }
    robot_frames::require_turns(ball.A, "profiler", mount == SensorMount::on_arm ? "the flange" : "the base");
    ball.solve_linear({});
    constexpr int kSides = 5;
    for (int round = 0; round < kSides; ++round) {
        ball.solve_linear(off_plane_of(ball));
    }
    // The weights hang on the frame, and are taken from where the first fit has it.
    std::vector<std::size_t> all(profiles.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        all[i] = i;
    }
    ball.move(ball.fit(all).shared);
    const robot_frames::RobustFit robust = robot_frames::fit_without_outliers(
        profiles.size(), kLeastSections, [&](const std::vector<std::size_t>& kept) { return ball.fit(kept); });
    std::vector<double> mm;
    for (std::size_t i = 0; i < profiles.size(); ++i) {
        mm.push_back(ball.error(i, robust.fit.shared).norm());
    }
    ball.move(robust.fit.shared);
    RobotFrame result;
    result.frame = ball.X;
    result.target.translation() = ball.c;
    result.work_point = Vector3d::Zero();
    for (std::size_t i = 0; i < profiles.size(); ++i) {
        result.work_point += ball.centre_in_sensor(i) / static_cast<double>(profiles.size());
    }
    robot_frames::add_residuals(names, robust, mm, std::vector<double>(mm.size()), result);
    robot_frames::judge_fit(robust, 6, options, result);
    return result;
}

}  // namespace seampath
