#include <algorithm>

#include "datasets/regression/case_run.hpp"
#include "datasets/regression/regression_json.hpp"
#include "pipeline/files.hpp"
#include "pipeline/json_text.hpp"
#include "stages/error.hpp"

namespace seampath {
namespace {

constexpr std::size_t kMaxRunBytes = std::size_t{16} << 20;
constexpr const char* kRunSchema = "seampath case run 1";

}  // namespace

nlohmann::ordered_json run_object(const CaseRun& run) {
    return {{"schema", kRunSchema},
            {"case", run.id},
            {"seed", run.seed},
            {"key", run.key},
            {"status", kRunStatusNames[static_cast<std::size_t>(run.status)]},
            {"outcome", run.outcome},
            {"message", run.message},
            {"metrics", numbers_json(run.measured)},
            {"hashes", hashes_json(run.measured)}};
}

CaseRun run_from(const nlohmann::ordered_json& json) {
    const auto status = std::find(kRunStatusNames.begin(), kRunStatusNames.end(), json.at("status").get<std::string>());
    if (json.at("schema") != kRunSchema || status == kRunStatusNames.end()) {
        throw InputError("dataset: a run of another schema or status");
    }
    CaseRun run;
    run.id = json.at("case").get<std::string>();
    run.seed = json.at("seed").get<std::uint64_t>();
    run.key = json.at("key").get<std::string>();
    run.status = static_cast<RunStatus>(status - kRunStatusNames.begin());
    run.outcome = json.at("outcome").get<std::string>();
    run.message = json.at("message").get<std::string>();
    run.measured = measurements_from(json);
    return run;
}

std::string case_run_json(const CaseRun& run) {
    return run_object(run).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

CaseRun read_case_run(const std::filesystem::path& file) {
    const std::string text = read_file(file, kMaxRunBytes, "dataset");
    try {
        return run_from(parse_json(text));
    } catch (const std::runtime_error&) {  // no JSON, or another schema
    } catch (const nlohmann::json::exception&) {
    }
    throw InputError("dataset: " + file.string() + " is no result of a case as this build writes it; run it again");
}

}  // namespace seampath
