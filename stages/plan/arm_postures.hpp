#pragma once

#include <optional>
#include <vector>

#include "stages/plan/arm_track.hpp"

/// Private to the plan stage: the postures of an arm along a chain, and how good they are.
namespace seampath::planning {

struct Posture {
    JointAngles q;         ///< in [-pi, pi)
    double dexterity = 0;  ///< manipulability over the largest that the arm has, about
};

class Postures {
public:
    Postures(const Chain& chain, const ArmCell& cell, const TrackOptions& options);

    const Chain& chain() const { return chain_; }
    const Arm& arm() const { return cell_.arm; }
    const TrackOptions& options() const { return options_; }

    /// Rolls that are tried, rad, ascending; the middle one is 0.
    const std::vector<double>& rolls() const { return rolls_; }

    /// All postures of a pose at a roll of rolls(); computed once.
    const std::vector<Posture>& at(std::size_t pose, std::size_t roll);

    /// The posture of a pose at any roll that goes on from `before`; nothing when none is near enough.
    std::optional<JointAngles> next(std::size_t pose, double roll, const JointAngles& before) const;

    /// Whether the arm may go from the pose before to this one: no axis above its speed or the longest step.
    bool may_step(std::size_t pose, const JointAngles& before, const JointAngles& q) const;

    /// Largest speed on the way to a pose, over its limit.
    double speed_share(std::size_t pose, const JointAngles& before, const JointAngles& q) const;

    double dexterity(const JointAngles& q) const { return manipulability(cell_.arm, q) / options_.best_manipulability; }

    /// The flange's pose.
    Eigen::Isometry3d flange(std::size_t pose, double roll) const;

private:
    const Chain& chain_;
    const ArmCell& cell_;
    TrackOptions options_;
    std::vector<double> rolls_;
    std::vector<std::optional<std::vector<Posture>>> table_;
    Eigen::Isometry3d tool_from_flange_;
};

/// 0 to 1: how far a posture is from limits and singular poses.
double goodness(double limit_margin, double dexterity);

/// A way that kept its postures, moved by whole turns of each axis into the limits as far from them as possible;
/// otherwise the first pose that no such turns hold, and which axis.
struct Lifted {
    std::vector<JointAngles> q;
    std::size_t stop = 0;  ///< number of poses when it is whole
    int axis = -1;
};
Lifted lift(const Arm& arm, std::vector<JointAngles> q);

/// The cheapest way over postures and changing rolls, or how far any gets.
std::variant<Track, Stop> track_with_changes(Postures& postures);

/// Score of a way.
double score_of(const Postures& postures, const std::vector<JointAngles>& q);

}  // namespace seampath::planning
