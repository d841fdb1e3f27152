#include "pipeline/config.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "pipeline/fields.hpp"
#include "pipeline/files.hpp"
#include "pipeline/json_text.hpp"
#include "pipeline/text.hpp"
#include "stages/error.hpp"

namespace seampath {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxConfigBytes = std::size_t{1} << 20;

/// Collects what is wrong, so that all of it is told at once.
class Problems {
public:
    void add(const std::string& origin, const std::string& path, const std::string& what) {
        lines_ += (lines_.empty() ? "" : "\n") + origin + ": " + path + ": " + what;
    }
    void throw_if_any() const {
        if (!lines_.empty()) {
            throw InputError(lines_);
        }
    }

private:
    std::string lines_;
};

std::vector<std::string_view> stage_names(const std::vector<Section>& sections) {
    std::vector<std::string_view> names;
    for (const auto& section : sections) {
        names.push_back(section.stage);
    }
    return names;
}

std::vector<std::string_view> key_names(const Section& section) {
    std::vector<std::string_view> names;
    for (const auto& field : section.fields) {
        names.push_back(field.key);
    }
    return names;
}

const Section* find_section(const std::vector<Section>& sections, std::string_view stage) {
    const auto found =
        std::find_if(sections.begin(), sections.end(), [&](const Section& s) { return s.stage == stage; });
    return found == sections.end() ? nullptr : &*found;
}

const Field* find_field(const Section& section, std::string_view key) {
    const auto found =
        std::find_if(section.fields.begin(), section.fields.end(), [&](const Field& f) { return f.key == key; });
    return found == section.fields.end() ? nullptr : &*found;
}

/// A key that is known, but stands in another section.
std::string elsewhere(const std::vector<Section>& sections, std::string_view key) {
    for (const auto& section : sections) {
        if (find_field(section, key) != nullptr) {
            return "; did you mean /" + std::string(section.stage) + "/" + std::string(key) + "?";
        }
    }
    return {};
}

std::string unknown_section(const std::vector<Section>& sections, std::string_view stage) {
    const auto names = stage_names(sections);
    std::string advice = hint(stage, names);
    if (advice.empty()) {
        advice = elsewhere(sections, stage);
    }
    return "there is no such section" + (advice.empty() ? "; there are " + join(names) : advice);
}

std::string unknown_key(const std::vector<Section>& sections, const Section& section, std::string_view key) {
    const auto names = key_names(section);
    std::string advice = elsewhere(sections, key);
    if (advice.empty()) {
        advice = hint(key, names);
    }
    return "there is no such option" + (advice.empty() ? "; there are " + join(names) : advice);
}

/// Sets one option by stage and key; whatever is wrong goes to `problems` under `origin`.
void set_option(const std::vector<Section>& sections, const std::string& stage, const std::string& key,
                const Json& value, const std::string& origin, Problems& problems) {
    const std::string path = "/" + stage + "/" + key;
    const Section* section = find_section(sections, stage);
    if (section == nullptr) {
        problems.add(origin, path, unknown_section(sections, stage));
        return;
    }
    const Field* field = find_field(*section, key);
    const std::string problem = field ? assign(*field, value) : unknown_key(sections, *section, key);
    if (!problem.empty()) {
        problems.add(origin, path, problem);
    }
}

void apply_text(const std::vector<Section>& sections, std::string_view text, const std::string& origin,
                Problems& problems) {
    Json root;
    try {
        root = parse_json(text);
    } catch (const JsonError& error) {
        problems.add(origin, "/", error.what());
        return;
    }
    if (!root.is_object()) {
        problems.add(origin, "/", json_excerpt(root) + " is not an object with one section a stage");
        return;
    }
    for (const auto& [stage, options] : root.items()) {
        if (find_section(sections, stage) == nullptr) {
            problems.add(origin, "/" + stage, unknown_section(sections, stage));
        } else if (!options.is_object()) {
            problems.add(origin, "/" + stage, json_excerpt(options) + " is not an object of options");
        } else {
            for (const auto& [key, value] : options.items()) {
                set_option(sections, stage, key, value, origin, problems);
            }
        }
    }
}

bool takes_text(const std::vector<Section>& sections, const std::string& stage, const std::string& key) {
    const Section* section = find_section(sections, stage);
    const Field* field = section ? find_field(*section, key) : nullptr;
    return field &&
           (std::holds_alternative<std::string*>(field->value) || std::holds_alternative<Choice>(field->value));
}

/// Text options take the value as it stands; all others read it as JSON.
Json override_value(const std::string& value, bool as_text) {
    if (as_text) {
        return value;
    }
    try {
        return parse_json(value);
    } catch (const JsonError&) {
        return value;  // no JSON, so a text: the option's own check says what it needs
    }
}

void apply_override(const std::vector<Section>& sections, const Override& given, Problems& problems) {
    const auto dot = given.path.find('.');
    if (dot == std::string::npos) {
        const std::string known = elsewhere(sections, given.path);
        problems.add(given.origin, "/" + given.path, "an option is named stage.key" + known);
        return;
    }
    const std::string stage = given.path.substr(0, dot);
    const std::string key = given.path.substr(dot + 1);
    if (!is_utf8(given.value)) {
        problems.add(given.origin, "/" + stage + "/" + key, json_excerpt(given.value) + " is not UTF-8");
        return;
    }
    set_option(sections, stage, key, override_value(given.value, takes_text(sections, stage, key)), given.origin,
               problems);
}

/// What no single field's bounds can say, each under the origin that set the option last.
void add_problems(const std::vector<std::string>& found, const std::string& stage, const std::string& file,
                  std::span<const Override> overrides, Problems& problems) {
    for (const std::string& problem : found) {
        const auto colon = problem.find(": ");
        const std::string key = problem.substr(0, colon);
        std::string origin = file;
        for (const auto& given : overrides) {
            origin = given.path == stage + "." + key ? given.origin : origin;
        }
        problems.add(origin, "/" + stage + "/" + key, problem.substr(colon + 2));
    }
}

}  // namespace

std::vector<Section> describe(Config& config) {
    return {{"read", describe(config.read)},         {"extract", describe(config.extract)},
            {"place", describe(config.place)},       {"fit", describe(config.fit)},
            {"validate", describe(config.validate)}, {"plan", describe(config.plan)},
            {"export", describe(config.export_)}};
}

Override parse_override(const std::string& argument) {
    const auto equals = argument.find('=');
    if (equals == std::string::npos) {
        throw InputError("--set: \"" + argument +
                         "\" has no value; stage.key=value was needed, e.g. plan.speed_mm_s=6");
    }
    return {"--set", argument.substr(0, equals), argument.substr(equals + 1)};
}

void apply_overrides(const std::vector<Section>& sections, std::span<const Override> overrides) {
    Problems problems;
    for (const auto& given : overrides) {
        apply_override(sections, given, problems);
    }
    problems.throw_if_any();
}

Config parse_config(std::string_view text, const std::string& file_name, std::span<const Override> overrides) {
    Config config;
    Problems problems;
    const auto sections = describe(config);
    apply_text(sections, text, file_name, problems);
    for (const auto& given : overrides) {
        apply_override(sections, given, problems);
    }
    add_problems(plan_problems(config.plan), "plan", file_name, overrides, problems);
    add_problems(export_problems(config.export_), "export", file_name, overrides, problems);
    problems.throw_if_any();
    return config;
}

Config read_config(const std::optional<std::filesystem::path>& file, std::span<const Override> overrides) {
    if (!file) {
        return parse_config("{}", "defaults", overrides);
    }
    return parse_config(read_file(*file, kMaxConfigBytes, "config"), file->string(), overrides);
}

std::string config_json(const Config& config) {
    Config copy = config;
    Json root = Json::object();
    for (const auto& section : describe(copy)) {
        root[std::string(section.stage)] = fields_json(section.fields);
    }
    return root.dump(4) + "\n";
}

std::string options_json(const Config& config, std::string_view stage) {
    return parse_json(config_json(config)).at(std::string(stage)).dump();
}

std::string options_table(const std::vector<Section>& sections) {
    std::string table;
    for (const auto& section : sections) {
        std::vector<std::vector<std::string>> rows{{"key", "unit", "default", "values", "meaning"}};
        for (const auto& field : section.fields) {
            rows.push_back({std::string(section.stage) + "." + std::string(field.key), std::string(unit_of(field.key)),
                            field_json(field).dump(), domain_text(field), std::string(field.meaning)});
        }
        table += table.empty() ? "" : "\n";
        table += aligned(rows);
    }
    return table;
}

std::string options_table(std::string_view stage) {
    Config config;
    const auto sections = describe(config);
    if (stage.empty()) {
        return options_table(sections);
    }
    const Section* section = find_section(sections, stage);
    if (section == nullptr) {
        const auto names = stage_names(sections);
        throw InputError("options: \"" + std::string(stage) + "\" is no stage; there are " + join(names) +
                         hint(stage, names));
    }
    return options_table(std::vector<Section>{*section});
}

std::string config_schema() {
    Config config;
    Json properties = Json::object();
    for (const auto& section : describe(config)) {
        Json options = Json::object();
        for (const auto& field : section.fields) {
            Json schema = field_schema(field);
            schema["default"] = field_json(field);
            schema["description"] = field.meaning;
            options[std::string(field.key)] = std::move(schema);
        }
        properties[std::string(section.stage)] = {
            {"type", "object"}, {"additionalProperties", false}, {"properties", std::move(options)}};
    }
    const Json root{{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                    {"title", "Seampath configuration"},
                    {"type", "object"},
                    {"additionalProperties", false},
                    {"properties", std::move(properties)}};
    return root.dump(4) + "\n";
}

}  // namespace seampath
