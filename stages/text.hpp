#pragma once

#include <charconv>
#include <string>
#include <string_view>

namespace seampath {

/// A number with so many decimals, never "-0.0"; the same on every locale.
inline std::string fixed(double value, int decimals) {
    char buffer[400];  // the largest double has 309 digits before its point
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::fixed, decimals).ptr;
    const std::string_view text(buffer, static_cast<std::size_t>(end - buffer));
    const bool minus_zero = text.starts_with('-') && text.find_first_not_of("-0.") == std::string_view::npos;
    return std::string(text.substr(minus_zero ? 1 : 0));
}

/// The shortest text that reads back as exactly this number ("nan", "inf", "-inf" for the others).
inline std::string shortest(double value) {
    char buffer[40];
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
    return {buffer, end};
}

}  // namespace seampath
