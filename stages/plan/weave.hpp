#pragma once

#include <vector>

#include "stages/plan/torch.hpp"

/// Private to the plan stage: how the wire swings about the seam.
namespace seampath::planning {

/// A whole number of swings along one weld, of a pitch as near as that lets it to plan.weave_pitch_mm, or to
/// plan.speed_mm_s / plan.weave_frequency_hz. With f the phase of a swing, 0 to 1, phi = 2 pi f, a the amplitude and
/// psi half the angle between the flanks, the wire is off the seam, in its own frame, by (along travel, across towards
/// flank 1, up out of the joint):
///   sine          0, a sin phi, 0
///   zigzag        0, 0 to a to -a to 0 in straight lines, 0
///   triangle      from the root (0, 0, 0) along flank 1 to (0, a, a / tan psi), across to flank 2, and back
///   circle        a (cos phi - 1), a sin phi, 0
///   figure-eight  a / 2 sin 2 phi, a sin phi, 0
/// At each side, where it is furthest off, it waits for plan.weave_dwell_s while the seam passes under it: the rest of
/// the swing is that much faster. It begins and ends on the seam.
class Weave {
public:
    /// Throws InputError for a weld shorter than half a swing.
    Weave(const TorchPath& path, const PlanOptions& options);

    double pitch_mm() const { return pitch_; }

    /// Off the seam, in the frame of TorchPath::middle().
    Eigen::Vector3d offset(const TorchPath& path, const TorchPose& pose) const;

    /// Between which the offset is within error_mm() of straight.
    const std::vector<double>& stations() const { return stations_; }
    double error_mm() const { return error_; }

private:
    double phase(double share) const;
    double share(double phase) const;

    const PlanOptions& options_;
    double pitch_ = 0, dwell_ = 0, side_ = 0, error_ = 0;  ///< dwell: share of a swing; side: phase of the first one
    std::vector<double> stations_;
};

}  // namespace seampath::planning
