#include "stages/geometry/arm.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "stages/angle.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;

constexpr double kMmPerM = 1000;

// Angles a limit and its own rounding differ by.
constexpr double kAtLimit = 1e-9;

}  // namespace

Eigen::Isometry3d forward(const Arm& arm, const JointAngles& q) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    for (int i = 0; i < kArmAxes; ++i) {
        const ArmAxis& axis = arm.axes[static_cast<std::size_t>(i)];
        const Eigen::Matrix3d turn = Eigen::AngleAxisd(q[i], axis.direction).toRotationMatrix();
        Eigen::Isometry3d step;
        step.linear() = turn;
        step.translation() = axis.point - turn * axis.point;
        step.makeAffine();
        pose = pose * step;
    }
    return pose * arm.base_from_flange;
}

Eigen::Matrix<double, 6, kArmAxes> jacobian(const Arm& arm, const JointAngles& q) {
    std::array<Vector3d, kArmAxes> direction, point;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    for (int i = 0; i < kArmAxes; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const ArmAxis& axis = arm.axes[k];
        direction[k] = pose.linear() * axis.direction;
        point[k] = pose * axis.point;
        pose = pose * Eigen::Translation3d(axis.point) * Eigen::AngleAxisd(q[i], axis.direction) *
               Eigen::Translation3d(-axis.point);
    }
    const Vector3d flange = pose * arm.base_from_flange.translation();
    Eigen::Matrix<double, 6, kArmAxes> J;
    for (int i = 0; i < kArmAxes; ++i) {
        const auto k = static_cast<std::size_t>(i);
        J.block<3, 1>(0, i) = direction[k].cross(flange - point[k]);
        J.block<3, 1>(3, i) = direction[k];
    }
    return J;
}

double manipulability(const Arm& arm, const JointAngles& q) {
    Eigen::Matrix<double, 6, kArmAxes> J = jacobian(arm, q);
    J.topRows<3>() /= kMmPerM;
    return std::abs(J.determinant());
}

double limit_margin(const Arm& arm, const JointAngles& q) {
    double least = kTurn;
    for (int i = 0; i < kArmAxes; ++i) {
        const ArmAxis& axis = arm.axes[static_cast<std::size_t>(i)];
        least = std::min({least, q[i] - axis.lowest, axis.highest - q[i]});
    }
    return least;
}

std::vector<JointAngles> within_limits(const Arm& arm, const JointAngles& q) {
    std::vector<JointAngles> all{q};
    for (int i = 0; i < kArmAxes; ++i) {
        const ArmAxis& axis = arm.axes[static_cast<std::size_t>(i)];
        const double first = std::ceil((axis.lowest - kAtLimit - q[i]) / kTurn);
        std::vector<JointAngles> more;
        for (double turns = first; q[i] + turns * kTurn <= axis.highest + kAtLimit; ++turns) {
            for (JointAngles way : all) {
                way[i] = std::clamp(q[i] + turns * kTurn, axis.lowest, axis.highest);
                more.push_back(way);
            }
        }
        all = std::move(more);
    }
    return all;
}

JointAngles nearest_turns(const JointAngles& q, const JointAngles& reference) {
    JointAngles near = q;
    for (int i = 0; i < kArmAxes; ++i) {
        near[i] += kTurn * std::round((reference[i] - q[i]) / kTurn);
    }
    return near;
}

}  // namespace seampath
