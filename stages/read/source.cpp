#include "stages/read/source.hpp"

#include <algorithm>
#include <limits>

#include "stages/error.hpp"

namespace seampath {

void fail(const Source& source, std::string_view what) {
    throw InputError("read: " + source.label + ": " + std::string(what));
}

void fail_at_byte(const Source& source, std::size_t offset, std::string_view what) {
    fail(source, "byte " + std::to_string(offset) + ": " + std::string(what));
}

void fail_at_line(const Source& source, std::size_t offset, std::string_view what) {
    const std::string_view before = source.bytes.substr(0, offset);
    const auto line = std::count(before.begin(), before.end(), '\n') + 1;
    fail(source, "line " + std::to_string(line) + ": " + std::string(what));
}

std::string in_quotes(std::string_view bytes) {
    constexpr std::size_t kShown = 40;
    std::string text = "'";
    for (const char c : bytes.substr(0, kShown)) {
        text += c >= ' ' && c <= '~' ? c : '?';
    }
    return text + (bytes.size() > kShown ? "...'" : "'");
}

std::optional<double> parse_number_slowly(std::string_view token) {
    if (token.starts_with('+')) {
        token.remove_prefix(1);
        if (token.starts_with('-')) {
            return std::nullopt;
        }
    }
    double value = 0;
    const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
    if (token.empty() || end != token.data() + token.size() || error == std::errc::invalid_argument) {
        return std::nullopt;
    }
    if (error == std::errc::result_out_of_range) {
        const bool tiny = token.find("e-") != token.npos || token.find("E-") != token.npos;
        return tiny ? 0.0 : std::numeric_limits<double>::infinity();
    }
    return value;
}

}  // namespace seampath
