#include "pipeline/json_object.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/files.hpp"
#include "pipeline/json_text.hpp"
#include "pipeline/text.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

constexpr double kLargestNumber = 1e9;  // mm, px: their squares keep all digits

}  // namespace

JsonObject::JsonObject(const Json& value, std::string place, std::vector<std::string>& problems,
                       std::vector<std::string_view> keys)
    : value_(value), place_(std::move(place)), problems_(problems) {
    if (value.is_null()) {
        return;
    }
    if (!value.is_object()) {
        complain("", "is " + json_excerpt(value) + "; an object was needed");
        return;
    }
    for (const auto& [key, given] : value.items()) {
        if (std::find(keys.begin(), keys.end(), key) == keys.end()) {
            complain(key, "there is no such key" + hint(key, keys));
        }
    }
}

void JsonObject::complain(const std::string& key, const std::string& what) const {
    problems_.push_back((key.empty() ? (place_.empty() ? "/" : place_) : place_of(key)) + ": " + what);
}

const JsonObject::Json& JsonObject::member(const char* key) const {
    static const Json kNone;
    if (!has(key)) {
        if (value_.is_object() || value_.is_null()) {  // of anything else it was said that it is no object
            complain(key, "is missing");
        }
        return kNone;
    }
    return value_.at(key);
}

std::vector<double> JsonObject::numbers(const char* key, std::size_t count) const {
    return has(key) ? numbers_of(value_.at(key), key, count) : (member(key), std::vector<double>());
}

std::vector<double> JsonObject::numbers_of(const Json& value, const std::string& key, std::size_t count) const {
    std::vector<double> all;
    const bool list = value.is_array() && value.size() == count;
    for (std::size_t i = 0; list && i < count; ++i) {
        if (value[i].is_number() && std::abs(value[i].get<double>()) <= kLargestNumber) {
            all.push_back(value[i].get<double>());
        }
    }
    if (all.size() != count) {
        complain(key, json_excerpt(value) + " is not " +
                          (count == 1 ? "a number" : std::to_string(count) + " numbers") + " of at most 1e9");
        return {};
    }
    return all;
}

double JsonObject::number(const char* key) const {
    const Json& value = member(key);
    if (!has(key)) {
        return 0;
    }
    const auto all = numbers_of(Json::array({value}), key, 1);
    return all.empty() ? 0 : all[0];
}

double JsonObject::positive(const char* key, double otherwise) const {
    if (!has(key)) {
        return otherwise;
    }
    const auto all = numbers_of(Json::array({value_.at(key)}), key, 1);
    if (!all.empty() && !(all[0] > 0)) {
        complain(key, shortest(all[0]) + " is not above 0");
    }
    return all.empty() || !(all[0] > 0) ? otherwise : all[0];
}

std::string JsonObject::text(const char* key) const {
    const Json& value = member(key);
    if (has(key) && !value.is_string()) {
        complain(key, json_excerpt(value) + " is no text");
    }
    return value.is_string() ? value.get<std::string>() : std::string();
}

std::size_t JsonObject::word(const char* key, std::span<const std::string_view> words) const {
    const std::string given = text(key);
    const auto found = std::find(words.begin(), words.end(), given);
    if (found == words.end() && has(key)) {
        complain(key, "\"" + given + "\" is unknown; there are " + join(words) + hint(given, words));
    }
    return found == words.end() ? 0 : static_cast<std::size_t>(found - words.begin());
}

void read_json_file(const std::filesystem::path& file, std::size_t max_bytes, const std::string& who,
                    const std::string& what,
                    const std::function<void(const JsonObject::Json&, std::vector<std::string>&)>& take) {
    const std::string text = read_file(file, max_bytes, who);
    JsonObject::Json root;
    try {
        root = parse_json(text);
    } catch (const JsonError& error) {
        throw InputError(who + ": " + file.string() + ": " + error.what() + "; " + what);
    }
    std::vector<std::string> problems;
    take(root, problems);
    std::string lines;
    for (const std::string& problem : problems) {
        lines += (lines.empty() ? "" : "\n") + file.string() + ": " + problem;
    }
    if (!lines.empty()) {
        throw InputError(lines);
    }
}

}  // namespace seampath
