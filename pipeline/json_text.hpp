#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace seampath {

/// What is wrong with a JSON text, with line and column.
class JsonError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Parses JSON with comments, keys in the order of the text. Throws JsonError on a syntax error, on a key that stands
/// twice in one object, and on more than 64 levels of nesting.
nlohmann::ordered_json parse_json(std::string_view text);

/// Only UTF-8 can be written as JSON; a command line or file name may hold other bytes.
bool is_utf8(std::string_view text);

/// One line of JSON for a message; bytes that are no UTF-8 are replaced, long values cut.
std::string json_excerpt(const nlohmann::ordered_json& value);

}  // namespace seampath
