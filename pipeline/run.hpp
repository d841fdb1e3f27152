#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

#include "pipeline/result.hpp"

namespace seampath {

/// The stages in their order: read, extract, place, fit, validate, plan, export.
inline constexpr std::array<std::string_view, 7> kStageNames{"read",     "extract", "place", "fit",
                                                             "validate", "plan",    "export"};

/// What a run tells while it goes, and how it is stopped. Any of them may be empty.
struct Progress {
    std::function<void(std::string_view stage)> begin;
    std::function<void(const StageTiming& timing)> end;
    std::function<bool()> stop;  ///< asked between stages and files; true ends the run with Interrupted
};

/// Artefacts of an earlier run are taken over where their key still holds, for the stages before `recompute_from`.
struct Resume {
    std::size_t recompute_from = kStageNames.size();  ///< index into kStageNames; 0: nothing is taken over
};

/// One part on its way through the program: scan file in, run folder with seams, programs and report out.
/// The folder's files are those of README, "Files in a run folder"; each appears whole or not at all, and all of them
/// depend on scan, config and build alone (times go to `progress` and are in no file; 1-scan.json says where the scan
/// lies from the folder, report.html when the scan's file was last written). A run that was killed goes on from its
/// last good artefact. No programs are written for seams out of tolerance unless export.even_if_out_of_tolerance.
/// Throws InputError (scan, config, folder), Interrupted, InternalError. No seam found is a result, not an error.
PartResult run_part(const std::filesystem::path& scan_file, const std::filesystem::path& out, const Config& config,
                    const Resume& resume = {}, const Progress& progress = {});

/// The same way for a scan in memory, without a folder and without a report.
PartResult run_part(Scan scan, const Config& config, const Progress& progress = {});

/// Seams that follow from nominal dimensions, without a scan: planned, exported and reported like those of a part. The
/// folder gets the same files but those of a scan and of the stages that work on one. Throws as run_part does.
PartResult run_nominal(const std::string& name, std::vector<SeamModel> models, const std::filesystem::path& out,
                       const Config& config, const Progress& progress = {});

}  // namespace seampath
