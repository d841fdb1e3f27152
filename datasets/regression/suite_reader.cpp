#include "datasets/regression/suite_reader.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "pipeline/fields.hpp"
#include "pipeline/json_text.hpp"
#include "pipeline/text.hpp"
#include "stages/error.hpp"

namespace seampath {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMostSeeds = 1000;

}  // namespace

void SuiteProblems::add(const std::string& place, const std::string& what) {
    if (seen_.insert(place + what).second) {
        lines_ += (lines_.empty() ? "" : "\n") + file_ + ": " + place + ": " + what;
    }
}

void SuiteProblems::throw_if_any() const {
    if (!lines_.empty()) {
        throw InputError(lines_);
    }
}

void read_fields(const Json& object, const Fields& fields, const KeyNames& others, const std::string& place,
                 SuiteProblems& problems) {
    if (!object.is_object()) {
        problems.add(place, json_excerpt(object) + " is not an object");
        return;
    }
    KeyNames known = others;
    for (const Field& field : fields) {
        known.push_back(field.key);
    }
    for (const auto& [key, value] : object.items()) {
        const auto field =
            std::find_if(fields.begin(), fields.end(), [&, name = key](const Field& f) { return f.key == name; });
        std::string problem;
        if (field != fields.end()) {
            problem = assign(*field, value);
        } else if (std::find(known.begin(), known.end(), key) == known.end()) {
            const std::string near = hint(key, known);
            problem = "there is no such key" + (near.empty() ? "; there are " + join(known) : near);
        }
        if (!problem.empty()) {
            problems.add(place + "/" + key, problem);
        }
    }
}

const Json& member_of(const Json& object, const char* key) {
    static const Json kNone;
    return object.is_object() && object.contains(key) ? object.at(key) : kNone;
}

std::vector<std::string> texts_of(const Json& list, const std::string& place, SuiteProblems& problems) {
    std::vector<std::string> texts;
    if (!list.is_null() && !list.is_array()) {
        problems.add(place, json_excerpt(list) + " is no list of texts");
        return texts;
    }
    for (const Json& text : list) {
        if (text.is_string()) {
            texts.push_back(text.get<std::string>());
        } else {
            problems.add(place, json_excerpt(text) + " is no text");
        }
    }
    return texts;
}

std::vector<std::uint64_t> seeds_of(const Json& json, const std::string& place, SuiteProblems& problems) {
    std::vector<std::uint64_t> seeds;
    if (json.is_number_unsigned() && json.get<double>() >= 1 && json.get<double>() <= kMostSeeds) {
        for (std::uint64_t seed = 1; seed <= json.get<std::uint64_t>(); ++seed) {
            seeds.push_back(seed);
        }
        return seeds;
    }
    for (const Json& seed : json.is_array() ? json : Json::array()) {
        if (seed.is_number_unsigned()) {
            seeds.push_back(seed.get<std::uint64_t>());
        }
    }
    const std::set<std::uint64_t> different(seeds.begin(), seeds.end());
    if (seeds.empty() || seeds.size() != json.size() || different.size() != seeds.size()) {
        problems.add(place, json_excerpt(json) + " are no seeds; their number, or a list of different whole numbers, " +
                                "was needed, e.g. 3 or [11, 12]");
    }
    return seeds;
}

}  // namespace seampath
