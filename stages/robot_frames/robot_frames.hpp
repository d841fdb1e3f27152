#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "stages/geometry/rigid.hpp"

/// Frames on a robot that are found by moving it: the tip of its tool, and a camera or line profiler on its arm or
/// beside it. Covariances of frames are in the order and axes of stages/geometry/rigid.hpp. Nothing hangs on the order
/// of the poses.
namespace seampath {

/// Random errors of the robot's poses and of the measurements, 1-sigma along and about each axis. Their ratios weigh
/// what was measured; how large they are in all comes from the residuals.
struct PoseNoise {
    double robot_mm = 0.05;
    double robot_rad = 3.5e-4;
    double sensor_mm = 0.05;
    double sensor_rad = 3.5e-4;
};

struct RobotFrameOptions {
    double limit_mm = 0.3;  ///< largest expanded uncertainty that passes
    PoseNoise noise;
    int trials = 2000;  ///< of the Monte-Carlo, at least 1000
    std::uint64_t seed = 1;
};

/// How one pose agrees with the others.
struct PoseResult {
    std::string name;
    double residual_mm = 0;
    double residual_rad = 0;  ///< 0 where no rotation is measured
    double without_mm = 0;    ///< how far the work point goes when the pose is left out
    double p_value = 1;       ///< that chance alone sets the pose this far from the others (F test)
    bool left_out = false;    ///< it does not fit the others, and is no part of the result
};

struct RobotFrame {
    Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();  ///< of the tool or sensor, in the flange or base
    Matrix6 covariance = Matrix6::Zero();
    Eigen::Isometry3d target = Eigen::Isometry3d::Identity();  ///< of what was measured: pivot, board or ball
    std::vector<PoseResult> poses;
    double residual_mm = 0;           ///< rms of the poses kept
    double residual_rad = 0;          ///< the same
    double largest_mm = 0;            ///< largest residual of the poses kept
    double sigma_ratio = 1;           ///< size of the residuals over what the noise given leads to
    int redundancy = 0;               ///< numbers measured beyond those needed
    Eigen::Vector3d work_point;       ///< frame of the tool or sensor, mm: where the uncertainty is stated
    double expanded_mm = 0;           ///< the distance that 95 % of the trials keep there
    Eigen::Vector3d weakest;          ///< unit, frame of flange or base: where the work point is least sure
    double weakest_mm = 0;            ///< 1-sigma along it
    std::vector<std::string> notes;   ///< what a reader should know, a sentence each
    std::vector<std::string> faults;  ///< why it does not pass, a sentence each
    bool pass() const { return faults.empty(); }
};

/// A pose of the flange in which something was measured.
struct FlangePose {
    std::string name;
    Eigen::Isometry3d base_from_flange = Eigen::Isometry3d::Identity();
};

/// The tool's tip in the flange's frame from poses in which it touches one point (pivot): the least squares of
///     R_i tip + t_i = point,
/// whose frame has the flange's axes. Poses that don't fit the others (F test) are left out. Throws InputError for
/// fewer than 4 poses, and for turns about one axis, which leave the tip's place along it open.
RobotFrame calibrate_tcp(const std::vector<FlangePose>& poses, const RobotFrameOptions& options);

/// A board seen by a camera in one pose.
struct BoardPose {
    FlangePose flange;
    Eigen::Isometry3d camera_from_board = Eigen::Isometry3d::Identity();
};

/// A sensor on the arm sees a target that stands still (eye in hand), or one that stands still sees a target on the arm
/// (eye to hand).
enum class SensorMount { on_arm, beside_arm };

/// The camera's frame X in the flange (or base) and the board's Y in the base (or flange), such that
///     A_i X B_i = Y,   A_i = base_from_flange (or its inverse), B_i = camera_from_board.
/// F. C. Park and B. J. Martin, Robot sensor calibration: solving AX = XB on the Euclidean group, IEEE Trans. Robotics
/// and Automation 10(5), 1994, over all pairs of poses, then least squares over all poses, each residual weighed by
/// what the noise of robot and camera leads to at the board. Poses that don't fit the others (F test) are left out. The
/// work point is the board's mean place. Throws InputError for fewer than 4 poses, and for turns about one axis.
RobotFrame calibrate_camera_mount(const std::vector<BoardPose>& poses, SensorMount mount,
                                  const RobotFrameOptions& options);

/// A profile of a ball, in one pose: points of the ball alone, mm, in the laser's plane, which is y = 0 of the sensor's
/// frame.
struct BallProfile {
    FlangePose flange;
    std::vector<Eigen::Vector2d> points;  ///< x, z
};

/// The line profiler's frame in the flange (or base) from sections of a ball of known radius. A section is a circle in
/// the laser's plane; with its radius rho the ball's centre lies sqrt(R^2 - rho^2) off the plane, on either side. Least
/// squares over all sections of the circle's place in the plane and of that distance, with the noise of the points and
/// of the robot, from a linear solution that takes every section for one through the centre. The work point is the
/// ball's mean place. Throws InputError for fewer than 6 sections, sections that are no circle of that ball, and for
/// turns about one axis.
RobotFrame calibrate_profiler_mount(const std::vector<BallProfile>& profiles, double radius_mm, SensorMount mount,
                                    const RobotFrameOptions& options);

}  // namespace seampath
