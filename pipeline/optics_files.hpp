#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/fixture_calibration.hpp"
#include "pipeline/json_object.hpp"
#include "stages/board/board.hpp"
#include "stages/optics/optics.hpp"
#include "stages/stripe/stripe.hpp"

/// Calibrations of cameras and lasers, from their files to their result files. JSON with comments, lengths in mm, paths
/// relative to the file, unknown keys are errors.
///
///     { "name": "top camera", "limit_percent": 0.1,
///       "board": { "kind": "chessboard", "columns": 11, "rows": 8, "pitch_mm": 15 },
///       "images": [ "01.png", ... ] }                                                                     camera
///
///     { "name": "top laser", "limit_mm": 0.05, "board": ...,
///       "camera": { "size_px": ..., "matrix_px": ..., "distortion": ... }  or  "result.json" of a camera,
///       "views": [ { "board": "b01.png", "stripe": "s01.png" }, ... ] }                                     laser
///
/// A board is "chessboard" (inner corners), "charuco" (squares; also "marker_mm" and "dictionary", e.g. "4x4_50") or
/// "circles" (an asymmetric grid; also "diameter_mm").
namespace seampath {

Board board_from(const JsonObject::Json& value, const std::string& place, std::vector<std::string>& problems);

/// A camera in a user's file: as in a capture file, or the name of a result file beside it. The first complains of what
/// is wrong; the second throws InputError for a result that can't be read or did not pass.
void check_camera(const JsonObject::Json& value, std::vector<std::string>& problems);
CameraModel camera_or_result(const JsonObject::Json& value, const std::filesystem::path& folder);

/// The board in a picture, which is noted with its hash. Throws InputError where it is not seen.
BoardPlace locate_in_picture(const std::filesystem::path& picture, const CameraModel& camera, const Board& board,
                             std::vector<InputFile>& inputs);

struct CameraRun {
    std::string name;
    Board board;
    CameraCalibration result;
    std::vector<std::string> without_board;  ///< pictures in which it was not found
    std::vector<InputFile> inputs;
    std::string date;  ///< ISO 8601, UTC; given by the caller
};

struct LaserRun {
    std::string name;
    CameraModel camera;
    LaserCalibration result;
    std::vector<InputFile> inputs;
    std::string date;
};

/// Throw InputError for files that can't be read or do not fit each other.
CameraRun calibrate_camera_file(const std::filesystem::path& file);
LaserRun calibrate_laser_file(const std::filesystem::path& file);

/// The camera of a result file that `calibrate camera` wrote. Throws InputError for another file, and for a camera that
/// did not pass.
CameraModel read_camera_result(const std::filesystem::path& file);

/// The laser's plane as a capture file has it.
LaserPlane laser_plane_of(const Plane& plane);

std::string camera_result_json(const CameraRun& run);
std::string camera_result_text(const CameraRun& run);
std::string laser_result_json(const LaserRun& run);
std::string laser_result_text(const LaserRun& run);

}  // namespace seampath
