#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace seampath {

/// What `seampath interpolate RUN_FOLDER` is asked.
struct InterpolateRun {
    std::filesystem::path folder;
    std::optional<std::filesystem::path> scan;  ///< where the run's scan is now
    std::vector<int> nodes{8, 16, 32};          ///< how many to try, ascending
    std::string out;                            ///< SVG file, or empty
    bool json = false;
};

/// Compares the interpolation methods on the seams of a run and prints the rankings. Returns the exit status: kPass
/// when on each seam the method of least rms is in tolerance, kOutOfTolerance otherwise or without a seam. Throws
/// InputError.
int interpolate_run(const InterpolateRun& given);

}  // namespace seampath
