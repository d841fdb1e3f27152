#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "stages/export/export.hpp"
#include "stages/extract/extract.hpp"
#include "stages/fit/fit.hpp"
#include "stages/place/place.hpp"
#include "stages/plan/plan.hpp"
#include "stages/read/read.hpp"
#include "stages/validate/validate.hpp"

namespace seampath {

/// One options struct a stage; the keys of the config file are the members' names (`export` for `export_`).
struct Config {
    ReadOptions read;
    ExtractOptions extract;
    PlaceOptions place;
    FitOptions fit;
    ValidateOptions validate;
    PlanOptions plan;
    ExportOptions export_;
};

/// The options of one stage under its name in the config file.
struct Section {
    std::string_view stage;
    Fields fields;
};

/// All sections in the order of the stages. The fields point into `config`, which must outlive them.
std::vector<Section> describe(Config& config);

/// A value from the command line: `origin` names it in messages ("--set"), `path` is "stage.key".
struct Override {
    std::string origin;
    std::string path;
    std::string value;
};

/// Splits "stage.key=value". Throws InputError when there is no "=".
Override parse_override(const std::string& argument);

/// Sets options by "stage.key". Throws one InputError with all problems, each as "--set: /plan/speed_mm_s: ...".
void apply_overrides(const std::vector<Section>& sections, std::span<const Override> overrides);

/// Defaults, then the config text (JSON with comments, one object a stage, every key optional), then the overrides in
/// their order. `file_name` is for messages only. Throws one InputError with all problems, a line each:
/// "file: /place/max_spacing_mm: -1 is not above 0", with a hint where a known name is near.
Config parse_config(std::string_view text, const std::string& file_name, std::span<const Override> overrides = {});

/// The same from a file, or from nothing. Throws InputError also when the file can't be read or is larger than 1 MiB.
Config read_config(const std::optional<std::filesystem::path>& file, std::span<const Override> overrides = {});

/// Every option with its value as JSON; parse_config() of it gives the same config.
std::string config_json(const Config& config);

/// The same for the options of one stage, on one line: what the stage's result depends on.
std::string options_json(const Config& config, std::string_view stage);

/// Every option of these sections as a table: key, unit, value, bounds, meaning.
std::string options_table(const std::vector<Section>& sections);

/// The same for one stage of the config, or for all when `stage` is empty, with the defaults as values.
/// Throws InputError for an unknown stage.
std::string options_table(std::string_view stage = {});

/// JSON schema (draft 2020-12) of the config file, for editors.
std::string config_schema();

}  // namespace seampath
