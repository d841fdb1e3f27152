#pragma once

#include <charconv>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

/// What every reader shares: the bytes of a file, messages that say where in them, lines, tokens and numbers.
/// Nothing here depends on the locale.
namespace seampath {

/// A file's bytes and what messages call it.
struct Source {
    std::string_view bytes;
    std::string label;
};

/// How messages about a damaged file end.
inline constexpr std::string_view kExportAgain = "; export or copy the file again";

/// Throws InputError "read: <label>: <what>".
[[noreturn]] void fail(const Source& source, std::string_view what);

/// Throws InputError "read: <label>: byte <offset>: <what>"; offsets count from 0.
[[noreturn]] void fail_at_byte(const Source& source, std::size_t offset, std::string_view what);

/// Throws InputError "read: <label>: line <n>: <what>" for the line that holds the byte at `offset`; lines count
/// from 1.
[[noreturn]] void fail_at_line(const Source& source, std::size_t offset, std::string_view what);

/// Text of untrusted bytes for a message: at most 40 of them, unprintable ones as '?', between quotes.
std::string in_quotes(std::string_view bytes);

inline bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

inline std::string_view trimmed(std::string_view s) {
    while (!s.empty() && is_blank(s.front())) {
        s.remove_prefix(1);
    }
    while (!s.empty() && is_blank(s.back())) {
        s.remove_suffix(1);
    }
    return s;
}

/// The line that begins at `offset`, without its end (LF or CRLF); moves `offset` behind that end.
inline std::string_view next_line(std::string_view bytes, std::size_t& offset) {
    const std::size_t end = bytes.find('\n', offset);
    std::string_view line = bytes.substr(offset, end == std::string_view::npos ? end : end - offset);
    offset = end == std::string_view::npos ? bytes.size() : end + 1;
    if (!line.empty() && line.back() == '\r') {
        line.remove_suffix(1);
    }
    return line;
}

/// Takes the next token of a line whose tokens stand apart by blanks; empty at the end of the line.
inline std::string_view next_token(std::string_view& line) {
    std::size_t begin = 0;
    while (begin < line.size() && is_blank(line[begin])) {
        ++begin;
    }
    std::size_t end = begin;
    while (end < line.size() && !is_blank(line[end])) {
        ++end;
    }
    const std::string_view token = line.substr(begin, end - begin);
    line.remove_prefix(end);
    return token;
}

/// A whole token as a number. "nan" and "inf" are numbers here; what is too large for a double counts as infinite.
std::optional<double> parse_number_slowly(std::string_view token);
inline std::optional<double> parse_number(std::string_view token) {
    double value = 0;
    const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
    if (error == std::errc{} && end == token.data() + token.size()) {
        return value;
    }
    return parse_number_slowly(token);
}

/// A whole token as an integer that the type can hold.
template <class Integer>
std::optional<Integer> parse_integer(std::string_view token) {
    Integer value = 0;
    const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
    if (error == std::errc{} && end == token.data() + token.size()) {
        return value;
    }
    return std::nullopt;
}

}  // namespace seampath
