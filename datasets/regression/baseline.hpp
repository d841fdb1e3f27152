#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "datasets/regression/case_run.hpp"

namespace seampath {

/// What came out of a case with one seed when it was accepted.
struct Golden {
    std::string outcome;
    Measurements measured;
};

/// The golden values of a case: `baseline.json` in the case's folder.
struct Baseline {
    std::string case_sha256;  ///< of the case's text when it was accepted
    std::string reason;       ///< given when it was accepted
    std::string date;         ///< ISO 8601, UTC
    std::string commit;
    std::map<std::uint64_t, Golden> seeds;
};

/// What a case is judged by: the baseline of its folder, or nothing where there is none, or one of another text of the
/// case. Throws InputError when the file can't be read.
std::optional<Baseline> read_baseline(const Suite& suite, const SuiteCase& entry);

/// Writes it, with those measurements only that a band of the case fits.
void write_baseline(const Suite& suite, const SuiteCase& entry, const Baseline& baseline);

}  // namespace seampath
