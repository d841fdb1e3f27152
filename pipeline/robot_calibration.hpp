#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/fixture_calibration.hpp"
#include "pipeline/fixture_history.hpp"
#include "stages/robot_frames/robot_frames.hpp"

/// Calibrations of frames on a robot, from their files to their result files. JSON with comments, lengths in mm, poses
/// x, y, z and the quaternion w, x, y, z; unknown keys are errors.
///
///     { "name": "torch 2", "limit_mm": 0.3,
///       "poses": [ { "name": "1", "base_from_flange": [x, y, z, qw, qx, qy, qz] }, ... ] }                     tcp
///
///     { "name": "cell 3", "sensor": "camera", "mount": "on-arm" (or "beside-arm"), "limit_mm": 0.3,
///       "noise": { "robot_mm": 0.05, "robot_deg": 0.02, "sensor_mm": 0.05, "sensor_deg": 0.02 },         (optional)
///       "poses": [ { "name": "1", "base_from_flange": [...], "camera_from_board": [...] }, ... ] }        hand-eye
///
///       or, in the place of camera_from_board, "image": "01.png" with "camera" and "board" as in
///       pipeline/optics_files.hpp
///
///     { "name": "cell 3", "sensor": "profiler", "mount": "on-arm", "ball_diameter_mm": 25.4,
///       "poses": [ { "name": "1", "base_from_flange": [...], "points_mm": [[x, z], ...] }, ... ] }        hand-eye
namespace seampath {

enum class RobotMethod { tcp, camera, profiler };

/// What was measured, one entry a pose in the list that belongs to the method.
struct RobotMeasurement {
    std::string name;
    RobotMethod method = RobotMethod::tcp;
    SensorMount mount = SensorMount::on_arm;
    double ball_diameter_mm = 0;
    RobotFrameOptions options;
    std::vector<FlangePose> tips;
    std::vector<BoardPose> boards;
    std::vector<BallProfile> profiles;
    std::vector<InputFile> pictures;  ///< of boards
};

/// Throw one InputError with all problems, a line each.
RobotMeasurement read_tcp_poses(const std::filesystem::path& file);
RobotMeasurement read_hand_eye(const std::filesystem::path& file);

struct RobotCalibration {
    RobotMeasurement measured;  ///< name, method and options of it
    RobotFrame frame;
    std::vector<InputFile> inputs;
    std::string date;  ///< ISO 8601, UTC
    std::optional<FrameChange> change;
    std::optional<Acceptance> accepted;
};

/// Measures, and notes the file with its hash.
RobotCalibration calibrate_robot(RobotMeasurement measured, const std::filesystem::path& file);

/// An earlier result that was accepted.
struct StoredRobotFrame {
    std::string name, method, date;
    Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
};

/// The accepted result in the file; empty where there is no file or none was accepted. Throws InputError when the file
/// is no result of a robot's calibration.
std::optional<StoredRobotFrame> accepted_robot_frame(const std::filesystem::path& file);

/// Compares with an accepted frame, at the work point; adds a fault when it moved by more than the limit. Throws
/// InputError when the accepted one is of something else.
void compare_with(const StoredRobotFrame& accepted, RobotCalibration& calibration);

std::string robot_result_json(const RobotCalibration& calibration);

/// The result as tables for a terminal.
std::string robot_result_text(const RobotCalibration& calibration);

HistoryRow history_row(const RobotCalibration& calibration);

}  // namespace seampath
