#pragma once

#include <array>
#include <charconv>
#include <string>

/// Private to the plan stage: numbers and names in its messages.
namespace seampath::planning {

inline std::string number(double value) {
    std::array<char, 32> text;
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 6).ptr;
    return {text.data(), end};
}

inline std::string seam_text(int seam) {
    return "plan: seam " + std::to_string(seam);
}

}  // namespace seampath::planning
