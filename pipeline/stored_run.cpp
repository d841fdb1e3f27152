#include "pipeline/stored_run.hpp"

#include <stdexcept>
#include <string>

#include "pipeline/artefact.hpp"
#include "pipeline/codec.hpp"
#include "pipeline/files.hpp"
#include "pipeline/scan_input.hpp"
#include "stages/error.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxArtefactBytes = std::size_t{1} << 31;

/// Decodes the artefact of a stage, whatever it was made from.
template <class Value>
Value load(const fs::path& file, std::string_view stage) {
    const std::string text = read_file(file, kMaxArtefactBytes, "run folder");
    const auto content = artefact_content(text, stage);
    Value value;
    try {
        if (content) {
            decode(*content, value);
            return value;
        }
    } catch (const std::runtime_error&) {  // of another build
    }
    throw InputError("run folder: " + file.string() + " is no whole artefact of the stage " + std::string(stage) +
                     " as this build writes it; run the scan again");
}

/// The file of that name, which a run over a scan leaves.
fs::path fitted(const fs::path& folder, const std::string& name) {
    if (!fs::is_regular_file(folder / name)) {
        throw InputError("run folder: " + folder.string() + " has no " + name +
                         "; a folder in which \"seampath run\" fitted the seams of a scan was needed");
    }
    return folder / name;
}

}  // namespace

StoredRun load_run(const fs::path& folder, const std::optional<fs::path>& scan_file) {
    if (!fs::is_regular_file(folder / "1-scan.json") || !fs::is_regular_file(folder / "2-seams.json")) {
        throw InputError("run folder: " + folder.string() +
                         " has no 1-scan.json and 2-seams.json; a folder that \"seampath run\" wrote was needed");
    }
    StoredRun run;
    run.config = read_config(folder / "config.resolved.json");
    const auto record = load<ScanRecord>(folder / "1-scan.json", "read");
    const fs::path file = scan_file ? *scan_file : (fs::weakly_canonical(folder) / record.file).lexically_normal();
    if (!fs::is_regular_file(file)) {
        throw InputError("run folder: the scan of " + folder.string() + " is not at " + file.string() +
                         " any more; say where it is with --scan FILE");
    }
    if (const std::string sha256 = scan_sha256(file); sha256 != record.file_sha256) {
        throw InputError("run folder: " + file.string() + " is not the scan of " + folder.string() +
                         ": its SHA-256 is " + sha256 + ", that of the run's scan " + record.file_sha256 +
                         "; say where that is with --scan FILE, or run this scan");
    }
    run.scan = read_scan(file, run.config.read).scan;
    run.seams = load<Extraction>(folder / "2-seams.json", "extract").seams;
    return run;
}

std::vector<SeamModel> load_models(const fs::path& folder) {
    return load<std::vector<SeamModel>>(fitted(folder, "4-models.json"), "fit");
}

std::vector<Deviation> load_deviations(const fs::path& folder) {
    return load<std::vector<Deviation>>(fitted(folder, "5-deviation.json"), "validate");
}

}  // namespace seampath
