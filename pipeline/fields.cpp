#include "pipeline/fields.hpp"

#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "pipeline/json_text.hpp"
#include "pipeline/text.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Json = nlohmann::ordered_json;

template <class... Functions>
struct Overloaded : Functions... {
    using Functions::operator()...;
};
template <class... Functions>
Overloaded(Functions...) -> Overloaded<Functions...>;

std::string bounds_problem(double value, const Bounds& bounds) {
    const bool too_low = bounds.low_open ? value <= bounds.low : value < bounds.low;
    if (!too_low && value <= bounds.high) {
        return {};
    }
    const std::string text = shortest(value);
    if (!std::isfinite(bounds.high)) {
        return text + (bounds.low_open ? " is not above " : " is not at least ") + shortest(bounds.low);
    }
    if (!std::isfinite(bounds.low)) {
        return text + " is not at most " + shortest(bounds.high);
    }
    return text + (bounds.low_open ? " is not above " : " is not between ") + shortest(bounds.low) +
           (bounds.low_open ? " and at most " : " and ") + shortest(bounds.high);
}

std::string assign_number(double& target, const Json& value, const Bounds& bounds) {
    if (!value.is_number()) {
        return json_excerpt(value) + " is not a number";
    }
    const auto number = value.get<double>();
    std::string problem = bounds_problem(number, bounds);
    if (problem.empty()) {
        target = number;
    }
    return problem;
}

std::string assign_int(int& target, const Json& value, const Bounds& bounds) {
    if (!value.is_number_integer()) {
        return json_excerpt(value) + " is not a whole number";
    }
    const auto number = value.get<double>();  // any JSON integer fits the range of a double
    Bounds held = bounds;
    held.low = std::max<double>(held.low, std::numeric_limits<int>::min());
    held.high = std::min<double>(held.high, std::numeric_limits<int>::max());
    const bool fits = std::abs(number) <= std::numeric_limits<int>::max();
    std::string problem = bounds_problem(number, fits ? bounds : held);
    if (problem.empty()) {
        target = static_cast<int>(number);
    }
    return problem;
}

std::string assign_list(std::vector<double>& target, const Json& value, const Field& field) {
    if (!value.is_array()) {
        return json_excerpt(value) + " is not a list of numbers";
    }
    if (field.length > 0 && value.size() != static_cast<std::size_t>(field.length)) {
        return "holds " + std::to_string(value.size()) + " values; " + std::to_string(field.length) +
               " numbers are needed";
    }
    std::vector<double> numbers(value.size());
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const std::string problem = assign_number(numbers[i], value[i], field.bounds);
        if (!problem.empty()) {
            return "value " + std::to_string(i) + ": " + problem;
        }
    }
    target = std::move(numbers);
    return {};
}

std::string assign_choice(const Choice& choice, const Json& value) {
    const std::string word = value.is_string() ? value.get<std::string>() : std::string();
    for (std::size_t i = 0; i < choice.names.size(); ++i) {
        if (value.is_string() && choice.names[i] == word) {
            choice.set(static_cast<int>(i));
            return {};
        }
    }
    return json_excerpt(value) + " is none of " + join(choice.names) + hint(word, choice.names);
}

void add_bounds(Json& schema, const Bounds& bounds) {
    if (std::isfinite(bounds.low)) {
        schema[bounds.low_open ? "exclusiveMinimum" : "minimum"] = bounds.low;
    }
    if (std::isfinite(bounds.high)) {
        schema["maximum"] = bounds.high;
    }
}

Json number_schema(const Json& type, const Bounds& bounds) {
    Json schema{{"type", type}};
    add_bounds(schema, bounds);
    return schema;
}

std::string bounds_text(const Bounds& bounds) {
    const bool low = std::isfinite(bounds.low);
    if (low && std::isfinite(bounds.high)) {
        return (bounds.low_open ? "> " : "") + shortest(bounds.low) + " to " + shortest(bounds.high);
    }
    if (low) {
        return (bounds.low_open ? "> " : ">= ") + shortest(bounds.low);
    }
    return std::isfinite(bounds.high) ? "<= " + shortest(bounds.high) : "any number";
}

}  // namespace

Json field_json(const Field& field) {
    return std::visit(
        Overloaded{[](const Choice& choice) { return Json(choice.names.at(static_cast<std::size_t>(choice.get()))); },
                   [](const std::optional<double>* value) { return *value ? Json(**value) : Json(); },
                   [](const auto* value) { return Json(*value); }},
        field.value);
}

Json fields_json(const Fields& fields) {
    Json object = Json::object();
    for (const Field& field : fields) {
        object[std::string(field.key)] = field_json(field);
    }
    return object;
}

std::string assign(const Field& field, const Json& value) {
    return std::visit(Overloaded{[&](bool* target) {
                                     if (!value.is_boolean()) {
                                         return json_excerpt(value) + " is neither true nor false";
                                     }
                                     *target = value.get<bool>();
                                     return std::string();
                                 },
                                 [&](int* target) { return assign_int(*target, value, field.bounds); },
                                 [&](double* target) { return assign_number(*target, value, field.bounds); },
                                 [&](std::optional<double>* target) {
                                     double number = 0;
                                     std::string problem =
                                         value.is_null() ? "" : assign_number(number, value, field.bounds);
                                     if (problem.empty()) {
                                         *target = value.is_null() ? std::nullopt : std::optional(number);
                                     }
                                     return problem;
                                 },
                                 [&](std::string* target) {
                                     if (!value.is_string()) {
                                         return json_excerpt(value) + " is not a text";
                                     }
                                     *target = value.get<std::string>();
                                     return std::string();
                                 },
                                 [&](std::vector<double>* target) { return assign_list(*target, value, field); },
                                 [&](const Choice& choice) { return assign_choice(choice, value); }},
                      field.value);
}

std::string_view unit_of(std::string_view key) {
    // the longest suffix first: "_mm_s" also ends in "_s"
    static constexpr std::pair<std::string_view, std::string_view> kUnits[] = {
        {"_per_mm", "1/mm"}, {"_per_deg", "1/deg"}, {"_deg_s", "deg/s"}, {"_mm_s", "mm/s"},
        {"_mm", "mm"},       {"_deg", "deg"},       {"_s", "s"}};
    for (const auto& [suffix, unit] : kUnits) {
        if (key.ends_with(suffix)) {
            return unit;
        }
    }
    return {};
}

std::string domain_text(const Field& field) {
    return std::visit(Overloaded{[](const bool*) { return std::string("true, false"); },
                                 [](const std::string*) { return std::string("text"); },
                                 [&](const std::vector<double>*) {
                                     return field.length > 0 ? std::to_string(field.length) + " numbers" : "numbers";
                                 },
                                 [](const Choice& choice) { return join(choice.names); },
                                 [&](const std::optional<double>*) { return bounds_text(field.bounds) + " or null"; },
                                 [&](const int*) { return "whole, " + bounds_text(field.bounds); },
                                 [&](const double*) { return bounds_text(field.bounds); }},
                      field.value);
}

Json field_schema(const Field& field) {
    return std::visit(Overloaded{[](const bool*) {
                                     return Json{{"type", "boolean"}};
                                 },
                                 [](const std::string*) {
                                     return Json{{"type", "string"}};
                                 },
                                 [&](const int*) { return number_schema("integer", field.bounds); },
                                 [&](const double*) { return number_schema("number", field.bounds); },
                                 [&](const std::optional<double>*) {
                                     return number_schema({"number", "null"}, field.bounds);
                                 },
                                 [&](const std::vector<double>*) {
                                     Json schema{{"type", "array"}, {"items", number_schema("number", field.bounds)}};
                                     if (field.length > 0) {
                                         schema["minItems"] = field.length;
                                         schema["maxItems"] = field.length;
                                     }
                                     return schema;
                                 },
                                 [](const Choice& choice) {
                                     return Json{{"enum", choice.names}};
                                 }},
                      field.value);
}

}  // namespace seampath
