#pragma once

#include <string>
#include <variant>
#include <vector>

#include "stages/plan/plan.hpp"

/// Private to the plan stage: one way of an arm from an approach to its retract.
namespace seampath::planning {

/// Where the torch's tip shall be at one moment, before it is turned about its wire.
struct ChainPose {
    Eigen::Isometry3d base_from_tool = Eigen::Isometry3d::Identity();
    Waypoint at;        ///< position and orientation in the scan; between two waypoints: interpolated
    int waypoint = -1;  ///< index into Plan::waypoints, or -1 between two of them
};
using Chain = std::vector<ChainPose>;

/// The waypoints `first` to `last` with so many poses in between that the arm's way from one to the next is short: the
/// straight moves at even speed that a controller makes of them.
Chain chain_of(const std::vector<Waypoint>& waypoints, std::size_t first, std::size_t last, const ArmCell& cell);

/// The arm all along a chain: one posture that never jumps.
struct Track {
    std::vector<JointAngles> q;  ///< one a pose, turns and all, within the limits
    std::vector<double> roll;    ///< one a pose, rad
    double score = 0;            ///< 0 to 1: how far from limits, singular poses and speed limits, the worst of them
    bool constant_roll() const;
};

/// How far the best of all ways gets and what ends it.
struct Stop {
    std::size_t pose = 0;
    std::string why;
};

struct TrackOptions {
    double max_roll = 0;   ///< rad
    double roll_step = 0;  ///< rad, of the rolls that are tried
    double most_step = 0;  ///< rad, of an axis from pose to pose
    bool roll_may_change = true;
    bool any = false;                ///< the first way that is whole will do
    double best_manipulability = 1;  ///< about the largest that the arm has
};

/// The best way: with the torch at one roll all along, of all rolls and postures that whose worst pose is best; where
/// none is whole, and roll may change, the cheapest way over postures and rolls at every pose (dynamic programming),
/// which costs for nearness to limits and singular poses, for the axes' ways and for turning about the wire, then with
/// its roll smoothed as far as the way stays good.
std::variant<Track, Stop> track(const Chain& chain, const ArmCell& cell, const TrackOptions& options);

}  // namespace seampath::planning
