#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/fixture_nominal.hpp"
#include "stages/calibrate/calibrate.hpp"
#include "stages/read/read.hpp"

/// One fixture calibration, from its files to its result file.
namespace seampath {

/// A number that belongs to one method, e.g. the noise on a ball.
struct MethodNumber {
    std::string name;
    double value = 0;
    std::string unit;
};

struct InputFile {
    std::string file;
    std::string sha256;
};

/// How far the frame is from an earlier one: the step about the part's origin, base axes, and the shift of each work
/// point.
struct FrameChange {
    std::string since;  ///< date of the earlier one
    Vector6 step = Vector6::Zero();
    std::vector<double> work_point_mm;
    double limit_mm = 0;
};

struct Acceptance {
    std::string date;
    std::string reason;
};

struct FixtureCalibration {
    NominalFixture nominal;
    FrameResult frame;
    std::vector<MethodNumber> numbers;
    std::vector<InputFile> inputs;
    std::string date;  ///< ISO 8601, UTC; given by the caller
    std::optional<FrameChange> change;
    std::optional<Acceptance> accepted;
    std::optional<Scan> scan;  ///< what was measured, where that is a scan
};

/// The frame from boards in a picture. Throws InputError when none is seen.
FrameResult frame_from_boards(const std::filesystem::path& picture, const NominalFixture& nominal,
                              std::vector<MethodNumber>& numbers);

/// Measures the fixture in the observations: a scan for balls and surfaces, a table of touched points for points and
/// planes, which a scan may show instead, a run for seams, a picture for boards. Throws InputError for files that can't
/// be read or do not fit the nominal one.
FixtureCalibration calibrate_fixture(const std::filesystem::path& observations, const std::filesystem::path& nominal,
                                     const ReadOptions& read_options);

/// What later runs need of a result file.
struct StoredFixture {
    std::string name;
    std::string date;
    bool pass = false;
    Eigen::Isometry3d base_from_part = Eigen::Isometry3d::Identity();
    Matrix6 covariance = Matrix6::Zero();
    std::optional<Acceptance> accepted;
};

/// Throws InputError when the file is no result of a fixture calibration.
StoredFixture read_fixture_result(const std::filesystem::path& file);

/// Compares with an accepted frame; adds a fault when a work point moved by more than the nominal file's limit.
void compare_with(const StoredFixture& accepted, FixtureCalibration& calibration);

std::string fixture_result_json(const FixtureCalibration& calibration);

/// The result as tables for a terminal.
std::string fixture_result_text(const FixtureCalibration& calibration);

}  // namespace seampath
