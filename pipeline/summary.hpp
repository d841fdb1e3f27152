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

/// "pass", "out of tolerance" or "no seam found".
std::string_view verdict(const PartResult& part);

/// One row a seam: kind, closed, length, rms, max, sigma, verdict; for a terminal.
std::string seam_table(const PartResult& part);

}  // namespace seampath
