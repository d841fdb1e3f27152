#pragma once

#include <string>

namespace seampath {

/// Now, or the date given, as 2026-11-26T05:00:00Z. Throws InputError for what is no date.
std::string date_of(const std::string& given);

/// Throws InputError unless --accept and --reason come together.
void check_acceptance(bool accept, const std::string& reason);

}  // namespace seampath
