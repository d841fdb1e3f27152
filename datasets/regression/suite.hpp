#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "datasets/scanner.hpp"
#include "datasets/scenes.hpp"
#include "stages/read/read.hpp"

/// Suites of regression cases: what is run, what must come out, and what counts as a change. A case is data: a row in
/// `suite.json` and a folder of its name beside it, which holds its files and its baseline.
namespace seampath {

/// Which way a metric gets better. `both`: it should stay as it is.
enum class Better { lower, higher, both };
inline constexpr std::array<std::string_view, 3> kBetterNames{"lower", "higher", "both"};

/// Whether a change for the worse fails the case, or is only said.
enum class Severity { fail, note };
inline constexpr std::array<std::string_view, 2> kSeverityNames{"fail", "note"};

/// How far a metric may change: by the larger of `absolute`, and `relative` times its golden value.
struct Band {
    std::string metric;  ///< a name; each * stands for any text
    double absolute = 0;
    double relative = 0;
    Better better = Better::lower;
    Severity severity = Severity::fail;
};

/// What is known of the true seam, and from where.
enum class TruthKind { analytic, measured, consensus, none };
inline constexpr std::array<std::string_view, 4> kTruthKindNames{"analytic", "measured", "consensus", "none"};

/// What must come out; a `frame` is that of a fixture. `recorded`: whatever the baseline has, seed by seed.
enum class Expectation { seam, no_seam, frame, refused, recorded };
inline constexpr std::array<std::string_view, 5> kExpectationNames{"seam", "no seam", "frame", "refused", "recorded"};

/// What the program is given: files, or what a generator makes of the case's scene. `balls` is a fixture to calibrate.
enum class CaseInput { files, scan, laser_stripe, depth, balls };
inline constexpr std::array<std::string_view, 5> kCaseInputNames{"files", "scan", "laser_stripe", "depth", "balls"};

/// A file of a case; the first is the one that is run.
struct CaseFile {
    std::filesystem::path path;
    std::string sha256;
    std::uint64_t bytes = 0;
};

struct SuiteCase {
    std::string id;
    CaseInput input = CaseInput::scan;
    std::vector<CaseFile> files;
    SceneOptions scene;
    std::string preset = "standard";
    ScannerOptions scanner;
    Unit unit = Unit::mm;  ///< of the scan's numbers; `automatic`: not known
    std::string joint;     ///< a joint kind, "several" or "none"
    TruthKind truth = TruthKind::analytic;
    std::filesystem::path truth_file;  ///< truth.json of a case of files; may be empty
    std::string licence;
    std::string origin;
    std::string config = "{}";         ///< of the run, as in a config file
    std::vector<std::uint64_t> seeds;  ///< of the generator; a case of files has the one seed 0
    Expectation expect = Expectation::seam;
    std::string reason;  ///< part of the message of a refusal
    std::vector<std::string> tags;
    bool threads = false;  ///< run it on 1, 2 and all processors, too, and compare every file
    double time_s = 60;    ///< most that a run of one seed may take
    double memory_mb = 2000;
    std::vector<Band> bands;  ///< the first that fits a metric counts
    std::string sha256;       ///< of what the case says, without its bands: results of another text are not its own
};

struct Suite {
    std::string name;
    std::filesystem::path folder;
    std::vector<SuiteCase> cases;
};

/// Reads `suite.json`, or that of a folder: JSON with comments. Throws one InputError with all problems, a line each:
/// "suite.json: /cases/3/scene/gap_mm: -1 is not at least 0".
Suite read_suite(const std::filesystem::path& file);

/// The band of a metric; null when the suite does not judge it.
const Band* band_of(const SuiteCase& entry, std::string_view metric);

}  // namespace seampath
