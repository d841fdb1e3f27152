#pragma once

#include <charconv>
#include <string>

namespace seampath {

/// A number with so many decimals, for messages; the same on every locale.
inline std::string fixed(double value, int decimals) {
    char buffer[400];
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::fixed, decimals).ptr;
    return {buffer, end};
}

/// The shortest text that reads back as exactly this number.
inline std::string shortest(double value) {
    char buffer[40];
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
    return {buffer, end};
}

}  // namespace seampath
