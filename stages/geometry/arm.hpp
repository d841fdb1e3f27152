#pragma once

#include <array>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

/// Robot arms of six turning axes: where the flange is, and which angles put it there. mm, rad, s.
namespace seampath {

inline constexpr int kArmAxes = 6;
using JointAngles = Eigen::Matrix<double, kArmAxes, 1>;

/// An axis of the arm as it lies in the base when all angles are 0.
struct ArmAxis {
    std::string name;
    Eigen::Vector3d point;      ///< on the axis, mm
    Eigen::Vector3d direction;  ///< unit; positive angles turn right-handed about it
    double lowest = 0;          ///< rad
    double highest = 0;
    double max_speed = 0;  ///< rad/s
};

/// What has a closed form: a wrist whose three axes meet, behind two parallel axes (most industrial arms), or three
/// parallel axes with the last two meeting (the UR family).
enum class ArmKind { spherical_wrist, three_parallel };

struct Arm {
    std::string name;
    std::array<ArmAxis, kArmAxes> axes;
    Eigen::Isometry3d base_from_flange = Eigen::Isometry3d::Identity();  ///< all angles 0
    ArmKind kind = ArmKind::spherical_wrist;
};

/// The kind of an arm with these axes. Throws InputError when it has no closed form of the two.
ArmKind kind_of(const Arm& arm);

/// base_from_flange: the product of exponentials exp(S_1 q_1) ... exp(S_6 q_6) M (Brockett 1984).
Eigen::Isometry3d forward(const Arm& arm, const JointAngles& q);

/// Of the flange's origin: mm per rad in the first three rows, rad per rad in the others, all along the base's axes.
Eigen::Matrix<double, 6, kArmAxes> jacobian(const Arm& arm, const JointAngles& q);

/// |det J| with lengths in m, Yoshikawa's manipulability: 0 where the arm is singular.
double manipulability(const Arm& arm, const JointAngles& q);

/// All angles in [-pi, pi) that put the flange there, at most 8, whatever the limits are; none when it is out of reach.
/// Closed forms by Paden and Kahan's subproblems, as Elias & Wen, IK-Geo (2022) use them, then Newton's method:
/// forward() of each is within 1e-7 mm and 1e-10 rad of the pose. Where an axis is free because the arm is singular, it
/// takes the angle that it has in `reference`.
std::vector<JointAngles> inverse(const Arm& arm, const Eigen::Isometry3d& base_from_flange,
                                 const JointAngles& reference = JointAngles::Zero());

/// Smallest distance of any axis from its limits, rad; below 0 outside them.
double limit_margin(const Arm& arm, const JointAngles& q);

/// q with so many whole turns added to each axis that it lies within its limits, in every way; empty when there is
/// none.
std::vector<JointAngles> within_limits(const Arm& arm, const JointAngles& q);

/// q with whole turns added to each axis, nearest to `reference`.
JointAngles nearest_turns(const JointAngles& q, const JointAngles& reference);

}  // namespace seampath
