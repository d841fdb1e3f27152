#pragma once

#include <cmath>
#include <limits>
#include <string>

#include <nlohmann/json.hpp>

#include "datasets/regression/case_run.hpp"
#include "stages/text.hpp"

/// Measurements and runs as JSON: numbers that JSON can't hold are the texts "nan", "inf" and "-inf".
namespace seampath {

inline nlohmann::ordered_json number_json(double value) {
    return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(shortest(value));
}

inline double number_from(const nlohmann::ordered_json& json) {
    if (json.is_string()) {
        const double infinite = std::numeric_limits<double>::infinity();
        return json == "inf" ? infinite : json == "-inf" ? -infinite : std::numeric_limits<double>::quiet_NaN();
    }
    return json.get<double>();
}

inline nlohmann::ordered_json numbers_json(const Measurements& measured) {
    auto object = nlohmann::ordered_json::object();
    for (const auto& [name, value] : measured.numbers) {
        object[name] = number_json(value);
    }
    return object;
}

inline nlohmann::ordered_json hashes_json(const Measurements& measured) {
    auto object = nlohmann::ordered_json::object();
    for (const auto& [name, value] : measured.hashes) {
        object[name] = value;
    }
    return object;
}

/// From the members `metrics` and `hashes` of an object. Throws nlohmann's exceptions where they are something else.
inline Measurements measurements_from(const nlohmann::ordered_json& object) {
    Measurements measured;
    for (const auto& [name, value] : object.at("metrics").items()) {
        measured.add(name, number_from(value));
    }
    for (const auto& [name, value] : object.at("hashes").items()) {
        measured.hashes.emplace_back(name, value.get<std::string>());
    }
    return measured;
}

/// A run as an object, and back. The second throws nlohmann's exceptions, or InputError for an unknown status.
nlohmann::ordered_json run_object(const CaseRun& run);
CaseRun run_from(const nlohmann::ordered_json& object);

}  // namespace seampath
