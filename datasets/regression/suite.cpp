#include "datasets/regression/suite.hpp"

#include <algorithm>
#include <set>

#include <nlohmann/json.hpp>

#include "datasets/regression/suite_reader.hpp"
#include "pipeline/config.hpp"
#include "pipeline/digest.hpp"
#include "pipeline/files.hpp"
#include "pipeline/json_text.hpp"
#include "pipeline/text.hpp"
#include "stages/error.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxSuiteBytes = std::size_t{4} << 20;
constexpr double kMostMegabytes = 1e6;

std::vector<Band> bands_of(const Json& json, const std::string& place, SuiteProblems& problems) {
    std::vector<Band> bands;
    if (!json.is_null() && !json.is_object()) {
        problems.add(place, json_excerpt(json) + " is not an object of metrics");
        return bands;
    }
    for (const auto& [metric, value] : json.items()) {
        Band band;
        band.metric = metric;
        read_fields(value,
                    {{"absolute", &band.absolute, "band", at_least(0)},
                     {"relative", &band.relative, "band, as a share of the golden value", at_least(0)},
                     {"better", choice(band.better, kBetterNames), "which way is better"},
                     {"severity", choice(band.severity, kSeverityNames), "of a change for the worse"}},
                    {}, place + "/" + metric, problems);
        bands.push_back(band);
    }
    return bands;
}

void read_files(const Json& list, SuiteCase& entry, const fs::path& folder, const std::string& place,
                SuiteProblems& problems) {
    if (!list.is_array() || list.empty()) {
        problems.add(place, json_excerpt(list) + " is no list of files");
        return;
    }
    for (std::size_t i = 0; i < list.size(); ++i) {
        const std::string here = place + "/" + std::to_string(i);
        std::string path, sha256;
        double bytes = -1;
        read_fields(list[i],
                    {{"path", &path, "from the suite's folder"},
                     {"sha256", &sha256, "64 hexadecimal digits"},
                     {"bytes", &bytes, "size of the file", at_least(0)}},
                    {}, here, problems);
        if (path.empty() || bytes < 0 || sha256.size() != 64 ||
            sha256.find_first_not_of("0123456789abcdef") != std::string::npos) {
            problems.add(here,
                         json_excerpt(list[i]) + " needs path, sha256 (64 hexadecimal digits) and bytes of the file");
        }
        entry.files.push_back({folder / path, sha256, static_cast<std::uint64_t>(std::max(0.0, bytes))});
    }
}

Fields row_fields(SuiteCase& entry, std::string& truth_file) {
    return {{"id", &entry.id, "name of the case and its folder"},
            {"input", choice(entry.input, kCaseInputNames), "what the program is given"},
            {"preset", &entry.preset, "scanner"},
            {"unit", choice(entry.unit, kUnitNames), "of the scan's numbers"},
            {"joint", &entry.joint, "kind of joint"},
            {"truth", choice(entry.truth, kTruthKindNames), "kind of truth"},
            {"truth_file", &truth_file, "truth.json, from the suite's folder"},
            {"licence", &entry.licence, "of the data"},
            {"origin", &entry.origin, "of the data"},
            {"expect", choice(entry.expect, kExpectationNames), "outcome"},
            {"reason", &entry.reason, "part of the message of a refusal"},
            {"threads", &entry.threads, "compare 1, 2 and all processors"},
            {"time_s", &entry.time_s, "most that a run may take", above(0)},
            {"memory_mb", &entry.memory_mb, "most that a run may take", within(1, kMostMegabytes)}};
}

/// What belongs together.
void check_row(const SuiteCase& entry, const std::string& place, SuiteProblems& problems) {
    if (entry.id.empty() || entry.id.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-") != std::string::npos) {
        problems.add(place + "/id", "\"" + entry.id + "\" is no name of a case; small letters, digits and - make one");
    }
    if (entry.licence.empty() || entry.origin.empty()) {
        problems.add(place, "licence and origin of the data are missing");
    }
    const bool files = entry.input == CaseInput::files;
    if (files && entry.truth == TruthKind::analytic && entry.expect != Expectation::refused) {
        problems.add(place + "/truth", "files have no analytic truth; measured, consensus or none was needed");
    }
    if (files && entry.threads) {
        problems.add(place + "/threads", "only scans that are made can be run on several numbers of processors");
    }
    const bool refused = entry.expect == Expectation::refused;
    if (refused == entry.reason.empty()) {
        problems.add(place + "/reason", refused ? "is missing: part of the message that the refusal must have"
                                                : "belongs to a case that expects \"refused\"");
    }
    KeyNames kinds(kJointKindNames.begin(), kJointKindNames.end());
    kinds.insert(kinds.end(), {"several", "none"});
    if (std::find(kinds.begin(), kinds.end(), entry.joint) == kinds.end()) {
        problems.add(place + "/joint", "\"" + entry.joint + "\" is no kind of joint; there are " + join(kinds) +
                                           hint(entry.joint, kinds));
    }
}

/// The text that a config's or preset's own check gives.
template <class F>
void checked(const std::string& place, SuiteProblems& problems, const F& f) {
    try {
        f();
    } catch (const InputError& error) {
        problems.add(place, error.what());
    }
}

SuiteCase read_row(const Json& row, const fs::path& folder, const std::string& place, SuiteProblems& problems) {
    SuiteCase entry;
    std::string truth_file;
    read_fields(row, row_fields(entry, truth_file), {"files", "scene", "scanner", "config", "seeds", "tags", "metrics"},
                place, problems);
    if (!truth_file.empty()) {
        entry.truth_file = folder / truth_file;
    }
    if (entry.input == CaseInput::files) {
        read_files(member_of(row, "files"), entry, folder, place + "/files", problems);
        entry.seeds = {0};
    } else {
        entry.seeds = seeds_of(member_of(row, "seeds"), place + "/seeds", problems);
        checked(place + "/preset", problems, [&] { entry.scanner = preset(entry.preset); });
    }
    const std::pair<const char*, Fields> generator[]{{"scene", describe(entry.scene)},
                                                     {"scanner", describe(entry.scanner)}};
    for (const auto& [key, fields] : generator) {
        if (row.contains(key)) {
            read_fields(row.at(key), fields, {}, place + "/" + key, problems);
        }
    }
    if (row.contains("config")) {
        entry.config = row.at("config").dump();
        checked(place, problems, [&] { parse_config(entry.config, "config"); });
    }
    entry.tags = texts_of(member_of(row, "tags"), place + "/tags", problems);
    entry.bands = bands_of(member_of(row, "metrics"), place + "/metrics", problems);
    check_row(entry, place, problems);
    Json said = row;
    for (const char* key : {"metrics", "tags", "time_s", "memory_mb", "licence", "origin"}) {
        said.erase(key);
    }
    entry.sha256 = sha256(said.dump());
    return entry;
}

/// One case for each of the row's presets; most rows have one.
std::vector<Json> rows_of(const Json& defaults, const Json& given, const std::string& place, SuiteProblems& problems) {
    if (!given.is_object()) {
        problems.add(place, json_excerpt(given) + " is not an object");
        return {};
    }
    Json row = defaults.is_object() ? defaults : Json::object();
    row.merge_patch(given);
    if (!row.contains("presets")) {
        return {row};
    }
    std::vector<Json> rows;
    for (std::string preset_name : texts_of(row.at("presets"), place + "/presets", problems)) {
        Json& one = rows.emplace_back(row);
        one.erase("presets");
        one["preset"] = preset_name;
        std::replace(preset_name.begin(), preset_name.end(), '_', '-');
        one["id"] = row.value("id", "") + "-" + preset_name;
    }
    return rows;
}

void read_cases(const Json& root, Suite& suite, SuiteProblems& problems) {
    const Json& list = member_of(root, "cases");
    if (!list.is_array() || list.empty()) {
        problems.add("/cases", "is no list of cases; one row a case was needed");
        return;
    }
    const std::vector<Band> bands = bands_of(member_of(root, "metrics"), "/metrics", problems);
    std::set<std::string> taken;
    for (std::size_t i = 0; i < list.size(); ++i) {
        const std::string place = "/cases/" + std::to_string(i);
        for (const Json& row : rows_of(member_of(root, "defaults"), list[i], place, problems)) {
            SuiteCase entry = read_row(row, suite.folder, place, problems);
            if (!taken.insert(entry.id).second) {
                problems.add(place + "/id", "\"" + entry.id + "\" stands twice");
            }
            entry.bands.insert(entry.bands.end(), bands.begin(), bands.end());
            suite.cases.push_back(std::move(entry));
        }
    }
}

/// Whether the text is what the pattern, in which * stands for anything, says.
bool fits(std::string_view pattern, std::string_view text) {
    const auto star = pattern.find('*');
    if (star == std::string_view::npos) {
        return pattern == text;
    }
    if (!text.starts_with(pattern.substr(0, star))) {
        return false;
    }
    for (std::size_t i = star; i <= text.size(); ++i) {
        if (fits(pattern.substr(star + 1), text.substr(i))) {
            return true;
        }
    }
    return false;
}

}  // namespace

Suite read_suite(const fs::path& file) {
    const fs::path path = fs::is_directory(file) ? file / "suite.json" : file;
    SuiteProblems problems(path.string());
    Suite suite;
    suite.folder = fs::absolute(path).parent_path();
    try {
        const Json root = parse_json(read_file(path, kMaxSuiteBytes, "suite"));
        std::string schema, about;
        int version = 0;
        read_fields(
            root,
            {{"schema", &schema, ""}, {"version", &version, ""}, {"name", &suite.name, ""}, {"about", &about, ""}},
            {"defaults", "metrics", "cases"}, "", problems);
        if (schema != "seampath suite" || version != 1) {
            problems.add("/schema", "\"" + schema + "\" of version " + std::to_string(version) +
                                        " is not known; \"seampath suite\" of version 1 was needed");
        }
        problems.throw_if_any();
        read_cases(root, suite, problems);
    } catch (const JsonError& error) {
        problems.add("/", error.what());
    }
    problems.throw_if_any();
    return suite;
}

const Band* band_of(const SuiteCase& entry, std::string_view metric) {
    const auto found = std::find_if(entry.bands.begin(), entry.bands.end(),
                                    [&](const Band& band) { return fits(band.metric, metric); });
    return found == entry.bands.end() ? nullptr : &*found;
}

}  // namespace seampath
