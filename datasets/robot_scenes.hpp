#pragma once

#include <cstdint>
#include <vector>

#include "stages/robot_frames/robot_frames.hpp"

/// Robots that are moved to find a tool's or sensor's frame, with known truth. All from one seed.
namespace seampath {

struct RobotScene {
    int poses = 15;
    double spread_rad = 0.6;  ///< turns about each axis, to either side
    PoseNoise noise;
    SensorMount mount = SensorMount::on_arm;
    bool one_axis = false;  ///< all turns are about the flange's z
    int moved = -1;         ///< in this pose, if there is such a one, what is measured has moved
    double moved_mm = 1;    ///< in a direction that the seed draws
};

/// Where things are in truth.
struct RobotTruth {
    Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
    Eigen::Isometry3d target = Eigen::Isometry3d::Identity();
};

struct TipPoses {
    RobotTruth truth;
    std::vector<FlangePose> poses;
};
TipPoses make_tip_poses(const RobotScene& scene, std::uint64_t seed);

struct BoardPoses {
    RobotTruth truth;
    std::vector<BoardPose> poses;
};
BoardPoses make_board_poses(const RobotScene& scene, std::uint64_t seed);

/// Sections of a ball: some in each of the scene's orientations.
struct BallSweep {
    double diameter_mm = 25.4;
    int sections = 4;         ///< an orientation
    int points = 200;         ///< a section
    double sigma_mm = 0.03;   ///< of a point, along the sensor's z
    double arc_rad = 1.0;     ///< half of what the sensor sees of a section
    double off_centre = 0.7;  ///< furthest section, in radii
};
struct BallProfiles {
    RobotTruth truth;
    std::vector<BallProfile> profiles;
};
BallProfiles make_ball_profiles(const RobotScene& scene, const BallSweep& sweep, std::uint64_t seed);

}  // namespace seampath
