#pragma once

#include <filesystem>
#include <optional>

#include "pipeline/config.hpp"
#include "stages/types.hpp"

namespace seampath {

/// What an earlier run took and found.
struct StoredRun {
    Config config;
    Scan scan;  ///< read again
    std::vector<Seam> seams;
};

/// From the folder of a run, without changing it. The scan is the file that the run read, or `scan_file`; its SHA-256
/// must be that of the run. Throws InputError when the folder is not one of a run, a file is missing or damaged, or the
/// scan is another one.
StoredRun load_run(const std::filesystem::path& folder, const std::optional<std::filesystem::path>& scan_file);

/// The curves that an earlier run fitted, one a seam. Throws InputError when the folder is not one of a run that came
/// so far, or the file is damaged.
std::vector<SeamModel> load_models(const std::filesystem::path& folder);

/// How far those curves were from the scan, one a seam. Throws as load_models does.
std::vector<Deviation> load_deviations(const std::filesystem::path& folder);

}  // namespace seampath
