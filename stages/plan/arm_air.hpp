#pragma once

#include <vector>

#include "stages/geometry/arm.hpp"

/// Private to the plan stage: moves through the air by the joints.
namespace seampath::planning {

struct JointMove {
    std::vector<double> time_s;  ///< from 0
    std::vector<JointAngles> q;
    std::vector<std::size_t> at_point;  ///< index of each of the points that it goes through
};

/// From rest to rest through the points (at least two, no neighbours equal), at 21 times or more and at the points
/// themselves: natural cubic splines over Marin's parameters of least largest acceleration (parametrize.hpp, minimax),
/// gone through by s = 10 u^3 - 15 u^4 + 6 u^5, u from 0 to 1, in the shortest time in which no axis exceeds its speed
/// or its acceleration (rad/s^2). Where the splines would leave the limits, the arm rests at every point instead.
JointMove joint_move(const Arm& arm, const std::vector<JointAngles>& points, const JointAngles& max_acceleration);

}  // namespace seampath::planning
