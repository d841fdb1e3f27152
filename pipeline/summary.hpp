#pragma once

#include <string>
#include <string_view>

#include "pipeline/result.hpp"

/// One line a stage: what went in, what came out, the quality number.
namespace seampath {

std::string read_summary(const PartResult& part);
std::string extract_summary(const PartResult& part);
std::string place_summary(const PartResult& part);
std::string fit_summary(const PartResult& part);
std::string validate_summary(const PartResult& part);
std::string plan_summary(const PartResult& part);
std::string export_summary(const PartResult& part);
std::string report_summary(const PartResult& part);

/// In a few words: "pass", or what is wrong with the part, its torch or its arm.
std::string_view verdict(const PartResult& part);

/// Where the programs lie, or why there are none.
std::string programs_summary(const PartResult& part, const std::string& folder);

/// One row a seam: kind, closed, length, rms, max, sigma, verdict; for a terminal.
std::string seam_table(const PartResult& part);

}  // namespace seampath
