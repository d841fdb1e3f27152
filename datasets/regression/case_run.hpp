#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "datasets/regression/metrics.hpp"
#include "datasets/regression/suite.hpp"

namespace seampath {

/// How the process of a run ended.
enum class RunStatus { done, crashed, time, memory, data };
inline constexpr std::array<std::string_view, 5> kRunStatusNames{"done", "crashed", "time", "memory", "data"};

/// One case with one seed, run.
struct CaseRun {
    std::string id;
    std::uint64_t seed = 0;
    std::string key;  ///< of what it was made from: the case's text, seed, files and build
    RunStatus status = RunStatus::done;
    std::string outcome;  ///< of a run that is done: "seam", "no seam", "frame", "refused"
    std::string message;  ///< of a refusal, or why it is not done
    Measurements measured;
};

/// What a run is made from; `build` is the SHA-256 of the program.
std::string run_key(const SuiteCase& entry, std::uint64_t seed, const std::string& build);

/// Empty, or why a file of the case is not the one that the suite means.
std::string data_problem(const SuiteCase& entry);

/// Makes or takes the input, runs the program's stages on it in `folder`/run, and measures. Times of the stages and of
/// the whole, and the most memory that the process had, are metrics, too. A refusal of the input is an outcome; what
/// else goes wrong is thrown.
CaseRun run_case(const SuiteCase& entry, std::uint64_t seed, const std::filesystem::path& folder);

/// As JSON text, and back. The second throws InputError, naming the file, when the text is not that of a run.
std::string case_run_json(const CaseRun& run);
CaseRun read_case_run(const std::filesystem::path& file);

}  // namespace seampath
