#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "stages/calibrate/calibrate.hpp"
#include "stages/geometry/board.hpp"
#include "stages/geometry/camera.hpp"
#include "stages/read/read.hpp"

/// The files that a fixture calibration reads.
namespace seampath {

enum class FixtureMethod { balls, points, three_points, planes, best_fit, seams, boards };
inline constexpr std::array<std::string_view, 7> kFixtureMethodNames{"balls",    "points", "three-points", "planes",
                                                                     "best-fit", "seams",  "boards"};

/// A datum plane and where it is to be touched.
struct NominalPlane {
    std::string name;
    Eigen::Vector3d normal;
    double offset_mm = 0;
    std::vector<NamedPoint> points;
};

/// The nominal surface of a best fit: a mesh, or a golden scan.
struct NominalSurfaceFile {
    std::filesystem::path file;
    Unit unit = Unit::automatic;
    double least_share = 0.15;
    std::optional<Eigen::Vector3d> scan_sensor_mm, surface_sensor_mm;
    std::optional<Eigen::Isometry3d> near;
};

/// A board on the fixture.
struct NominalBoard {
    std::string name;
    Board board;
    Eigen::Isometry3d part_from_board = Eigen::Isometry3d::Identity();
};

/// The boards of a fixture, and the camera that sees them.
struct NominalBoards {
    std::vector<NominalBoard> boards;
    CameraModel camera;
    Eigen::Isometry3d base_from_camera = Eigen::Isometry3d::Identity();
    std::optional<std::filesystem::path> camera_file;
};

/// What is known of a fixture before it is measured.
struct NominalFixture {
    std::string name;
    FixtureMethod method = FixtureMethod::balls;
    double ball_diameter_mm = 0;
    double match_tolerance_mm = 1;
    double sigma_mm = 0;               ///< 1-sigma of a touched point that names none of its own
    std::vector<NamedPoint> features;  ///< balls or points
    std::vector<NominalPlane> planes;
    std::optional<ProbeOptions> probes;  ///< of planes that a scan shows, instead of touched ones
    NominalSurfaceFile surface;
    std::vector<NominalSeam> seams;
    NominalBoards boards;
    std::vector<WorkPoint> work_points;
    double change_limit_mm = 0.2;  ///< most that a work point may have moved since the last accepted calibration
    FrameOptions frame;
};

/// The boards of a nominal file, from its members "boards", "camera" and "base_from_camera"; what is wrong is
/// complained of. Throws InputError for a camera's result that can't be read or did not pass.
NominalBoards nominal_boards(const nlohmann::ordered_json& value, const std::filesystem::path& folder,
                             std::vector<std::string>& problems);

/// Reads the nominal file: JSON with comments, all lengths in mm, files as they lie from it, unknown keys an error.
/// Throws one InputError with all problems, a line each.
NominalFixture read_nominal_fixture(const std::filesystem::path& file);

struct TouchedRow {
    std::string name;
    Eigen::Vector3d p;  ///< base frame, mm
    double sigma_mm = 0;
};

/// Reads touched points: a header `name,x,y,z` with an optional column `sigma_mm`, one row a point; a line
/// `# unit: m` says what the numbers are in, mm otherwise. `sigma_mm` stands for points without one. Throws InputError
/// naming file and line.
std::vector<TouchedRow> read_touched_points(const std::filesystem::path& file, double sigma_mm);

/// Reads measured seams: the folder of a run, or its seam_points.csv. Throws InputError naming file and line.
std::vector<std::vector<MeasuredSeamPoint>> read_measured_seams(const std::filesystem::path& file);

}  // namespace seampath
