#pragma once

#include <cstdint>
#include <string>
#include <string_view>

/// Text of the report: numbers without locale, names that can't break out of the page, bytes that travel in it.
namespace seampath {

/// A number for people: exactly `decimals` places, never "-0.000"; an en dash for a value that is not finite.
std::string decimal(double value, int decimals);

/// Digits in groups of three with narrow no-break spaces between them: 1 284 331.
std::string grouped(std::int64_t value);

/// The text with every byte sequence that is not UTF-8 replaced by U+FFFD.
std::string valid_utf8(std::string_view text);

/// Safe as HTML text and inside a double-quoted attribute; also repairs UTF-8.
std::string escape_html(std::string_view text);

/// RFC 4648 with padding, one line.
std::string base64(std::string_view bytes);

}  // namespace seampath
