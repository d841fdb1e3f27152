#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "stages/options.hpp"

/// Reading, writing and describing one option of a `describe()` list.
namespace seampath {

nlohmann::ordered_json field_json(const Field& field);

/// Key and value of each, as they stand in a config.
nlohmann::ordered_json fields_json(const Fields& fields);

/// Sets the option and returns an empty text, or leaves it as it is and returns what is wrong: "-1 is not above 0".
std::string assign(const Field& field, const nlohmann::ordered_json& value);

/// The unit that the key ends in, e.g. "mm/s", or empty.
std::string_view unit_of(std::string_view key);

/// What a value may be: "> 0", "0 to 1", "auto, mm, m, inch", "7 numbers".
std::string domain_text(const Field& field);

/// JSON schema of the value, without default and description.
nlohmann::ordered_json field_schema(const Field& field);

}  // namespace seampath
