#include "datasets/regression/baseline.hpp"

#include "datasets/regression/regression_json.hpp"
#include "pipeline/files.hpp"
#include "pipeline/json_text.hpp"
#include "stages/error.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxBaselineBytes = std::size_t{16} << 20;
constexpr const char* kBaselineSchema = "seampath baseline 1";

Measurements judged(const SuiteCase& entry, const Measurements& all) {
    Measurements kept;
    for (const auto& [name, value] : all.numbers) {
        if (band_of(entry, name)) {
            kept.add(name, value);
        }
    }
    for (const auto& [name, value] : all.hashes) {
        if (band_of(entry, name)) {
            kept.hashes.emplace_back(name, value);
        }
    }
    return kept;
}

Baseline baseline_from(const Json& json) {
    Baseline baseline;
    baseline.case_sha256 = json.at("case_sha256").get<std::string>();
    baseline.reason = json.at("reason").get<std::string>();
    baseline.date = json.at("date").get<std::string>();
    baseline.commit = json.at("commit").get<std::string>();
    for (const Json& seed : json.at("seeds")) {
        baseline.seeds[seed.at("seed").get<std::uint64_t>()] = {seed.at("outcome").get<std::string>(),
                                                                measurements_from(seed)};
    }
    return baseline;
}

}  // namespace

std::optional<Baseline> read_baseline(const Suite& suite, const SuiteCase& entry) {
    const fs::path file = suite.folder / entry.id / "baseline.json";
    if (!fs::exists(file)) {
        return std::nullopt;
    }
    std::string why;
    try {
        const Json json = parse_json(read_file(file, kMaxBaselineBytes, "baseline"));
        if (json.at("schema") == kBaselineSchema) {
            Baseline baseline = baseline_from(json);
            return baseline.case_sha256 == entry.sha256 ? std::optional(std::move(baseline)) : std::nullopt;
        }
        why = "its schema is " + json_excerpt(json.at("schema"));
    } catch (const JsonError& error) {
        why = error.what();
    } catch (const Json::exception& error) {
        why = error.what();
    }
    throw InputError("baseline: " + file.string() + " can't be read: " + why +
                     "; one that \"seampath dataset accept\" wrote was needed");
}

void write_baseline(const Suite& suite, const SuiteCase& entry, const Baseline& baseline) {
    Json seeds = Json::array();
    for (const auto& [seed, golden] : baseline.seeds) {
        const Measurements kept = judged(entry, golden.measured);
        seeds.push_back({{"seed", seed},
                         {"outcome", golden.outcome},
                         {"metrics", numbers_json(kept)},
                         {"hashes", hashes_json(kept)}});
    }
    const Json json{{"schema", kBaselineSchema}, {"case_sha256", entry.sha256}, {"reason", baseline.reason},
                    {"date", baseline.date},     {"commit", baseline.commit},   {"seeds", std::move(seeds)}};
    RunFolder(suite.folder / entry.id)
        .write("baseline.json", json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace seampath
