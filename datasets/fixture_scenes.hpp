#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "stages/calibrate/calibrate.hpp"
#include "stages/optics/optics.hpp"
#include "stages/types.hpp"

/// Fixtures with known truth, as a sensor sees them: `base` is the sensor's frame, in which a scan's points are; the
/// part stands anywhere in it.
namespace seampath {

/// Tooling balls on stems over a plate, among clutter.
struct BallScene {
    std::vector<NamedPoint> balls{
        {"B1", {0, 0, 40}}, {"B2", {400, 0, 70}}, {"B3", {370, 290, 45}}, {"B4", {40, 240, 130}}};
    double diameter_mm = 12.7;
    double sigma_mm = 0.03;      ///< along the line of sight
    int points_per_ball = 2000;  ///< on the cap that the sensor sees
    double cap_deg = 60;         ///< its half angle
    int clutter = 60000;         ///< points of plate, stems, pipes, blocks, balls of other sizes, and strays
    std::string moved;           ///< this ball is not where it should be
    double moved_mm = 0.2;       ///< in a direction that the seed draws
    bool mirrored = false;
};

/// A scan and where the part is in it.
struct FixtureScan {
    Scan scan;
    Eigen::Isometry3d base_from_part = Eigen::Isometry3d::Identity();
};

FixtureScan make_ball_scan(const BallScene& scene, std::uint64_t seed);

/// Four points and three datum planes of a part, touched with noise in all directions.
struct TouchedPart {
    Eigen::Isometry3d base_from_part = Eigen::Isometry3d::Identity();
    std::vector<FramePoint> points;
    std::vector<DatumPlane> planes;
};

TouchedPart make_touched_part(std::uint64_t seed, double sigma_mm = 0.01);

/// Three datum planes that meet in a corner, among clutter, in a scan.
struct ProbedPart {
    Scan scan;
    Eigen::Isometry3d base_from_part = Eigen::Isometry3d::Identity();
    Eigen::Isometry3d near = Eigen::Isometry3d::Identity();  ///< off by some mm and degrees
    std::vector<DatumPlane> planes;                          ///< where they are to be probed
};

ProbedPart make_probed_part(std::uint64_t seed, double sigma_mm = 0.03);

/// Corners of a board on a part, as a camera sees them.
struct SeenBoard {
    CameraModel camera;
    Eigen::Isometry3d part_from_board = Eigen::Isometry3d::Identity();
    Eigen::Isometry3d camera_from_part = Eigen::Isometry3d::Identity();
    std::vector<BoardSight> points;
};

SeenBoard make_seen_board(std::uint64_t seed, double sigma_px = 0.1);

/// Seams, and points a millimetre apart on the middle nine tenths of each, with noise across it.
struct SeamScene {
    SeamScene();
    std::vector<NominalSeam> seams;  ///< two straight ones and an arc
    double sigma_mm = 0.02;          ///< along either direction across
};

struct MeasuredSeams {
    Eigen::Isometry3d base_from_part = Eigen::Isometry3d::Identity();
    std::vector<std::vector<MeasuredSeamPoint>> seams;
};

MeasuredSeams make_measured_seams(const SeamScene& scene, std::uint64_t seed);

}  // namespace seampath
