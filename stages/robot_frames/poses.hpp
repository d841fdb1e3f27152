#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "stages/geometry/block_fit.hpp"
#include "stages/robot_frames/robot_frames.hpp"

/// What the calibrations by moving a robot have in common.
namespace seampath::robot_frames {

/// Throws InputError, beginning with `who`, when turns about one axis, or none, leave the place of a point that turns
/// with the poses open along it. `fixed_to` names the frame in which that axis stands.
void require_turns(const std::vector<Eigen::Isometry3d>& poses, const std::string& who, const std::string& fixed_to);

/// A fit of all poses but those that don't fit the others.
struct RobustFit {
    BlockFit fit;                   ///< blocks in the order of `kept`
    std::vector<std::size_t> kept;  ///< ascending
    std::vector<double> p_value;    ///< one a pose; of those left out, when they were
};

/// `fit` takes the poses that are kept. The pose that fits worst is left out as long as chance would set one so far
/// from the others once in a hundred calibrations, and no more than a quarter of all is.
RobustFit fit_without_outliers(std::size_t poses, std::size_t least,
                               const std::function<BlockFit(const std::vector<std::size_t>& kept)>& fit);

/// Fills covariance, poses' p-values and shifts, redundancy, uncertainty at the work point, notes and faults. The first
/// `of_frame` (3 or 6) of the shared parameters are the step of result.frame.
void judge_fit(const RobustFit& robust, Eigen::Index of_frame, const RobotFrameOptions& options, RobotFrame& result);

/// Residuals of the poses, in the order of the poses given, into the result; rms and largest over those kept.
void add_residuals(const std::vector<std::string>& names, const RobustFit& robust, const std::vector<double>& mm,
                   const std::vector<double>& rad, RobotFrame& result);

}  // namespace seampath::robot_frames
