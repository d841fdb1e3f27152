#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/fixture_calibration.hpp"

/// Every calibration of a folder, kept in an SQLite database that other programs can read, too.
namespace seampath {

/// One run, as it was written down.
struct HistoryRow {
    std::string date;  ///< ISO 8601, UTC
    std::string fixture;
    std::string method;
    std::string appraiser;  ///< who measured, or empty
    std::string part;       ///< which of several like parts, or empty
    bool pass = false;
    bool accepted = false;
    std::string reason;
    Eigen::Isometry3d base_from_part = Eigen::Isometry3d::Identity();
    double expanded_mm = 0;  ///< largest at a work point
    std::vector<WorkPoint> work_points;
    std::string nominal_sha256;
    std::string observations_sha256;
    std::string faults;  ///< a line each
};

/// Adds a row and makes it durable; the file is created when there is none. Throws InputError when it is no such
/// database or can't be written.
void add_to_history(const std::filesystem::path& database, const HistoryRow& row);

/// All rows in the order in which they were written. Throws InputError when there is no such database.
std::vector<HistoryRow> read_history(const std::filesystem::path& database);

HistoryRow history_row(const FixtureCalibration& calibration);

}  // namespace seampath
