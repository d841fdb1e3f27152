#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "stages/extract/extract.hpp"
#include "stages/types.hpp"

/// Stage results as JSON text and back, exactly: every number reads back as the same bits; NaN and infinities, which
/// JSON can't hold, are the texts "nan", "inf" and "-inf".
namespace seampath {

std::string encode(const Extraction& value);
std::string encode(const std::vector<Nodes>& value);
std::string encode(const std::vector<SeamModel>& value);
std::string encode(const std::vector<Deviation>& value);
std::string encode(const Plan& value);

/// The file that a scan is read from: its path from the run folder, and its SHA-256.
struct ScanRecord {
    std::string file;
    std::string file_sha256;
};

/// What is known of the scan without its points.
std::string encode(const Scan& scan, const ScanRecord& record);

/// Each throws std::runtime_error when the text isn't what encode() writes.
void decode(std::string_view text, Extraction& value);
void decode(std::string_view text, std::vector<Nodes>& value);
void decode(std::string_view text, std::vector<SeamModel>& value);
void decode(std::string_view text, std::vector<Deviation>& value);
void decode(std::string_view text, Plan& value);
void decode(std::string_view text, ScanRecord& value);

}  // namespace seampath
