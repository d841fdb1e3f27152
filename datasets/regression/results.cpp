#include "datasets/regression/results.hpp"

#include <algorithm>
#include <cmath>

#include "datasets/regression/regression_json.hpp"
#include "pipeline/files.hpp"
#include "pipeline/json_text.hpp"
#include "pipeline/report_text.hpp"
#include "pipeline/text.hpp"
#include "stages/error.hpp"

namespace seampath {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxResultsBytes = std::size_t{1} << 30;
constexpr const char* kResultsSchema = "seampath suite results 1";

std::string_view text_of(CaseVerdict verdict) {
    return kCaseVerdictNames[static_cast<std::size_t>(verdict)];
}

Json metrics_json(const std::vector<MetricChange>& metrics) {
    Json list = Json::array();
    for (const MetricChange& m : metrics) {
        list.push_back({{"name", m.name},
                        {"verdict", kMetricVerdictNames[static_cast<std::size_t>(m.verdict)]},
                        {"severity", kSeverityNames[static_cast<std::size_t>(m.severity)]},
                        {"golden", number_json(m.golden)},
                        {"now", number_json(m.now)},
                        {"difference", number_json(m.difference)},
                        {"allowed", number_json(m.allowed)},
                        {"why", m.why}});
    }
    return list;
}

/// "seam", or how many of which.
std::string outcome_of(const CaseResult& result) {
    std::vector<std::string> seen;
    for (const CaseRun& run : result.runs) {
        const std::string outcome = run.status == RunStatus::done
                                        ? run.outcome
                                        : std::string(kRunStatusNames[static_cast<std::size_t>(run.status)]);
        if (std::find(seen.begin(), seen.end(), outcome) == seen.end()) {
            seen.push_back(outcome);
        }
    }
    const std::vector<std::string_view> words(seen.begin(), seen.end());
    return join(words);
}

std::string shown_metric(const CaseResult& result, const std::string& metric, int decimals) {
    const double mean = mean_metric(result, metric);
    return std::isfinite(mean) ? decimal(mean, decimals) : "-";
}

std::string reasons_text(const CaseJudgement& judgement) {
    std::string text;
    for (const std::string& reason : judgement.reasons) {
        text += reason + "\n";
    }
    return text;
}

/// XML 1.0 has no other control characters.
std::string escape_xml(const std::string& text) {
    std::string plain;
    for (const char c : text) {
        const bool control = static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t';
        plain += control ? '?' : c;
    }
    return escape_html(plain);
}

}  // namespace

CaseVerdict verdict_of(const SuiteResults& results) {
    CaseVerdict worst = CaseVerdict::pass;
    for (const CaseResult& result : results.cases) {
        worst = std::max(worst, result.judgement.verdict);
    }
    return worst;
}

double mean_metric(const CaseResult& result, const std::string& metric) {
    double sum = 0, count = 0;
    for (const CaseRun& run : result.runs) {
        for (const auto& [name, value] : run.measured.numbers) {
            sum += name == metric ? value : 0;
            count += name == metric;
        }
    }
    return count > 0 ? sum / count : std::nan("");
}

std::string results_json(const SuiteResults& results) {
    Json cases = Json::array();
    for (const CaseResult& result : results.cases) {
        Json runs = Json::array();
        for (const CaseRun& run : result.runs) {
            runs.push_back(run_object(run));
        }
        cases.push_back({{"case", result.id},
                         {"verdict", text_of(result.judgement.verdict)},
                         {"reasons", result.judgement.reasons},
                         {"metrics", metrics_json(result.judgement.metrics)},
                         {"runs", std::move(runs)}});
    }
    const SuiteFacts& f = results.facts;
    const Json json{{"schema", kResultsSchema},
                    {"suite", f.suite},
                    {"suite_file", f.suite_file.string()},
                    {"date", f.date},
                    {"commit", f.commit},
                    {"build", f.build},
                    {"machine", f.machine},
                    {"verdict", text_of(verdict_of(results))},
                    {"cases", std::move(cases)}};
    return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

SuiteResults read_results(const std::filesystem::path& folder) {
    const std::filesystem::path file = folder / "results.json";
    const std::string text = read_file(file, kMaxResultsBytes, "dataset");
    try {
        const Json json = parse_json(text);
        if (json.at("schema") == kResultsSchema) {
            SuiteResults results;
            SuiteFacts& f = results.facts;
            f.suite_file = json.at("suite_file").get<std::string>();
            f.suite = json.at("suite").get<std::string>();
            f.date = json.at("date").get<std::string>();
            f.commit = json.at("commit").get<std::string>();
            f.build = json.at("build").get<std::string>();
            f.machine = json.at("machine").get<std::string>();
            for (const Json& one : json.at("cases")) {
                CaseResult& result = results.cases.emplace_back();
                result.id = one.at("case").get<std::string>();
                for (const Json& run : one.at("runs")) {
                    result.runs.push_back(run_from(run));
                }
            }
            return results;
        }
    } catch (const std::runtime_error&) {  // no JSON, or another schema
    } catch (const Json::exception&) {
    }
    throw InputError("dataset: " + file.string() +
                     " is no result of a suite as this build writes it; the --out folder of \"seampath dataset run\" "
                     "was needed");
}

std::string junit_xml(const SuiteResults& results) {
    std::size_t failures = 0, errors = 0;
    std::string rows;
    for (const CaseResult& result : results.cases) {
        const CaseVerdict verdict = result.judgement.verdict;
        const bool failed = verdict == CaseVerdict::regression;
        const bool error = verdict >= CaseVerdict::no_baseline && !failed;
        failures += failed;
        errors += error;
        const double seconds = mean_metric(result, "time_s") * static_cast<double>(result.runs.size());
        rows += "  <testcase classname=\"" + escape_xml(results.facts.suite) + "\" name=\"" + escape_xml(result.id) +
                "\" time=\"" + decimal(std::isfinite(seconds) ? seconds : 0, 3) + "\">\n";
        const std::string said = escape_xml(reasons_text(result.judgement));
        const std::string word(text_of(verdict));
        if (failed || error) {
            const std::string element = failed ? "failure" : "error";
            rows += "    <" + element + " message=\"" + word + "\">" + said + "</" + element + ">\n";
        } else if (!said.empty()) {
            rows += "    <system-out>" + said + "</system-out>\n";
        }
        rows += "  </testcase>\n";
    }
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"" + escape_xml(results.facts.suite) +
           "\" tests=\"" + std::to_string(results.cases.size()) + "\" failures=\"" + std::to_string(failures) +
           "\" errors=\"" + std::to_string(errors) + "\" timestamp=\"" + escape_xml(results.facts.date) + "\">\n" +
           rows + "</testsuite>\n";
}

std::string results_table(const SuiteResults& results) {
    std::vector<std::vector<std::string>> rows{
        {"case", "seeds", "outcome", "rms mm", "max mm", "found", "deviation mm", "time s", "verdict"}};
    std::string reasons;
    for (const CaseResult& result : results.cases) {
        rows.push_back({result.id, std::to_string(result.runs.size()), outcome_of(result),
                        shown_metric(result, "fitted_rms_mm", 4), shown_metric(result, "fitted_max_mm", 4),
                        shown_metric(result, "fitted_found", 3), shown_metric(result, "deviation_rms_mm", 4),
                        shown_metric(result, "time_s", 2), std::string(text_of(result.judgement.verdict))});
        for (const std::string& reason : result.judgement.reasons) {
            reasons += result.id + ": " + reason + "\n";
        }
    }
    return aligned(rows) + (reasons.empty() ? "" : "\n" + reasons);
}

}  // namespace seampath
