#pragma once

#include <string>
#include <vector>

#include "pipeline/config.hpp"
#include "stages/export/export.hpp"
#include "stages/extract/extract.hpp"
#include "stages/types.hpp"

namespace seampath {

/// What one stage did in this run.
struct StageTiming {
    std::string stage;
    double seconds = 0;
    bool resumed = false;  ///< taken from an earlier run's artefact
    std::string summary;   ///< what went in, what came out, the quality number
};

/// The file that a scan was read from; all empty for a nominal part and for a scan that was made in memory.
struct ScanOrigin {
    std::string file;     ///< its name, without folders
    std::string sha256;   ///< as scan_sha256() gives it
    std::string written;  ///< when it was last written, "2026-03-31 14:05 UTC"
};

/// Everything that is known of one part after a run. `nodes`, `models` and `deviations` run parallel to
/// `extraction.seams`; `plan` and `programs` hold only the seams that may be welded. A nominal part has a name and
/// models, plan and programs; of a scan and of what stages make of one it has nothing.
struct PartResult {
    Config config;
    bool nominal = false;  ///< the seams follow from dimensions, not from a scan
    Scan scan;
    ScanOrigin origin;
    Extraction extraction;
    std::vector<Nodes> nodes;
    std::vector<SeamModel> models;
    std::vector<Deviation> deviations;
    std::vector<int> planned_seams;  ///< indices into models, in the order of Waypoint::seam
    Plan plan;
    std::vector<ProgramFile> programs;
    std::vector<StageTiming> timings;

    /// At least one seam, and all of them in tolerance, where there is a scan to hold them against; none that leaves
    /// the torch no room; and an arm, where one is given, that makes the travel.
    bool pass() const;
};

/// Of a seam's nodes, mm.
std::vector<Eigen::Vector3d> node_positions(const Seam& seam, const Nodes& nodes);

}  // namespace seampath
