#include <cmath>

#include "stages/error.hpp"
#include "stages/robot_frames/poses.hpp"
#include "stages/robot_frames/robot_frames.hpp"

namespace seampath {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr std::size_t kLeastTips = 4;  // three leave too little to see a bad one by

Vector3d pivot_error(const FlangePose& pose, const VectorXd& tip_and_point) {
    return pose.base_from_flange * Vector3d(tip_and_point.head<3>()) - tip_and_point.tail<3>();
}

}  // namespace

RobotFrame calibrate_tcp(const std::vector<FlangePose>& poses, const RobotFrameOptions& options) {
    if (poses.size() < kLeastTips) {
        throw InputError(
            "tcp: " + std::to_string(poses.size()) +
            " poses are too few; at least 4, in different orientations, were needed; touch the point again");
    }
    std::vector<Isometry3d> turns;
    std::vector<std::string> names;
    for (const FlangePose& pose : poses) {
        turns.push_back(pose.base_from_flange);
        names.push_back(pose.name);
    }
    robot_frames::require_turns(turns, "tcp", "the flange");
    const auto fit = [&](const std::vector<std::size_t>& kept) {
        const BlockProblem problem{
            kept.size(), VectorXd::Ones(6), {}, [&](std::size_t i, const VectorXd& x, const auto&) {
                return VectorXd(pivot_error(poses[kept[i]], x) / options.noise.robot_mm);
            }};
        return fit_blocks(problem, VectorXd::Zero(6), std::vector<VectorXd>(kept.size()));
    };
    const robot_frames::RobustFit robust = robot_frames::fit_without_outliers(poses.size(), kLeastTips, fit);
    RobotFrame result;
    result.frame.translation() = robust.fit.shared.head<3>();
    result.target.translation() = robust.fit.shared.tail<3>();
    result.work_point = Vector3d::Zero();
    std::vector<double> mm;
    for (const FlangePose& pose : poses) {
        mm.push_back(pivot_error(pose, robust.fit.shared).norm());
    }
    robot_frames::add_residuals(names, robust, mm, std::vector<double>(poses.size()), result);
    robot_frames::judge_fit(robust, 3, options, result);
    return result;
}

}  // namespace seampath
