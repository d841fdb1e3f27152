#include "datasets/regression/suite_page.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/files.hpp"
#include "pipeline/report_text.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxDrawing = std::size_t{1} << 20;
constexpr double kTrendWide = 110, kTrendHigh = 28;  // CSS pixels

constexpr const char* kPageStyle =
    "<style>:root{color-scheme:light dark;--line:#8886;--dim:#777;--good:#00689d;--bad:#c0392b;--warn:#a66a00}"
    "@media(prefers-color-scheme:dark){:root{--good:#6cc0f0;--bad:#ff8a75;--warn:#f0b429;--dim:#aaa}}"
    "body{font:14px/1.4 system-ui,sans-serif;margin:2rem auto;max-width:80rem;padding:0 1rem}"
    "table{border-collapse:collapse;width:100%}th,td{text-align:left;padding:.3rem .6rem;border-bottom:1px solid "
    "var(--line);"
    "vertical-align:top}td.n,th.n{text-align:right;font-variant-numeric:tabular-nums}"
    ".pass{color:var(--good)}.bad{color:var(--bad);font-weight:600}.warn{color:var(--warn);font-weight:600}"
    ".dim{color:var(--dim)}.thumb{width:120px;height:80px}.dots{stroke:var(--dim);stroke-width:1.2;stroke-linecap:"
    "round;"
    "opacity:.55}.seam{fill:none;stroke:var(--good);stroke-width:2.2}.seam.out{stroke:var(--bad);stroke-dasharray:4 3}"
    ".trend{width:110px;height:28px}.trend path{fill:none;stroke:var(--good);stroke-width:1.5}"
    ".trend circle{fill:var(--good)}summary{cursor:pointer}@media print{details{display:none}}</style>";

std::string_view style_of(CaseVerdict verdict) {
    return verdict == CaseVerdict::pass ? "pass" : verdict <= CaseVerdict::no_baseline ? "warn" : "bad";
}

std::string cell(const std::string& html, std::string_view style = {}) {
    return "<td" + (style.empty() ? "" : " class=\"" + std::string(style) + "\"") + ">" + html + "</td>";
}

/// Four digits that count; an en dash for what is no number.
std::string digits(double value) {
    const double size = std::abs(value);
    const int decimals =
        size > 0 && std::isfinite(size) ? std::clamp(3 - static_cast<int>(std::floor(std::log10(size))), 0, 7) : 0;
    return decimal(value, decimals);
}

/// The metric in every run of the history, as a line from left to right with a dot at the last.
std::string trend_svg(const std::vector<HistoryRun>& history, const std::string& id, const std::string& metric) {
    std::vector<double> values;
    for (const HistoryRun& run : history) {
        for (const HistoryCase& one : run.cases) {
            const auto found = one.metrics.find(metric);
            if (one.id == id && found != one.metrics.end() && std::isfinite(found->second)) {
                values.push_back(found->second);
            }
        }
    }
    if (values.empty()) {
        return {};
    }
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    const double range = *high > *low ? *high - *low : 1;
    std::string path, last;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double part = values.size() > 1 ? static_cast<double>(i) / static_cast<double>(values.size() - 1) : 1;
        const std::string x = decimal(3 + part * (kTrendWide - 6), 1);
        const std::string y = decimal(kTrendHigh - 4 - (values[i] - *low) / range * (kTrendHigh - 8), 1);
        path += (i ? "L" : "M") + x + " " + y;
        last = "<circle cx=\"" + x + "\" cy=\"" + y + "\" r=\"2.5\"/>";
    }
    const std::string label = metric + " of " + std::to_string(values.size()) + " runs, from " + digits(*low) + " to " +
                              digits(*high) + ", last " + digits(values.back());
    return "<svg class=\"trend\" viewBox=\"0 0 110 28\" role=\"img\" aria-label=\"" + escape_html(label) +
           "\"><title>" + escape_html(label) + "</title><path d=\"" + path + "\"/>" + last + "</svg>";
}

const MetricChange* change_of(const CaseResult& result, std::string_view metric) {
    const auto found = std::find_if(result.judgement.metrics.begin(), result.judgement.metrics.end(),
                                    [&](const MetricChange& change) { return change.name == metric; });
    return found == result.judgement.metrics.end() ? nullptr : &*found;
}

/// The number now, and below it that of the baseline.
std::string number_cell(const CaseResult& result, const std::string& metric) {
    const double now = mean_metric(result, metric);
    if (!std::isfinite(now)) {
        return cell("");
    }
    const MetricChange* change = change_of(result, metric);
    const bool known = change && change->verdict != MetricVerdict::fresh;
    return cell(digits(now) + (known ? "<br><span class=\"dim\">" + digits(change->golden) + "</span>" : ""), "n");
}

/// Fails and what is better first, each as they come; the page is read from its top.
std::string metrics_table(const CaseResult& result) {
    std::vector<const MetricChange*> rows;
    for (const MetricChange& change : result.judgement.metrics) {
        rows.push_back(&change);
    }
    std::stable_sort(rows.begin(), rows.end(), [](const auto* a, const auto* b) { return a->verdict > b->verdict; });
    std::string html =
        "<table><tr><th>metric</th><th class=\"n\">baseline</th><th class=\"n\">now</th><th class=\"n\">difference</th>"
        "<th class=\"n\">allowed</th><th>verdict</th></tr>";
    for (const MetricChange* m : rows) {
        const bool fails = m->verdict == MetricVerdict::worse && m->severity == Severity::fail;
        html += "<tr>" + cell(escape_html(m->name)) + cell(digits(m->golden), "n") + cell(digits(m->now), "n") +
                cell(digits(m->difference), "n") + cell(digits(m->allowed), "n") +
                cell(std::string(kMetricVerdictNames[static_cast<std::size_t>(m->verdict)]) +
                         (m->severity == Severity::note ? ", note" : ""),
                     fails                               ? "bad"
                     : m->verdict == MetricVerdict::same ? ""
                                                         : "warn") +
                "</tr>";
    }
    return html + "</table>";
}

std::string links(const CaseResult& result, const fs::path& folder) {
    std::string html;
    for (const CaseRun& run : result.runs) {
        const fs::path report = fs::path("cases") / result.id / std::to_string(run.seed) / "run" / "report.html";
        const std::string seed = "seed " + std::to_string(run.seed);
        html += fs::exists(folder / report)
                    ? "<a href=\"" + escape_html(report.generic_string()) + "\">" + seed + "</a> "
                    : "<span class=\"dim\">" + seed + "</span> ";
    }
    return html;
}

/// Of the first seed that has one.
std::string drawing(const CaseResult& result, const fs::path& folder) {
    for (const CaseRun& run : result.runs) {
        const fs::path file = folder / "cases" / result.id / std::to_string(run.seed) / "thumbnail.svg";
        if (fs::exists(file)) {
            return read_file(file, kMaxDrawing, "dataset");
        }
    }
    return {};
}

std::string case_rows(const CaseResult& result, const std::vector<HistoryRun>& history, const fs::path& folder) {
    std::string said;
    for (const std::string& reason : result.judgement.reasons) {
        said += "<br>" + escape_html(reason);
    }
    const CaseVerdict verdict = result.judgement.verdict;
    const std::string word = "<b>" + std::string(kCaseVerdictNames[static_cast<std::size_t>(verdict)]) + "</b>" + said;
    return "<tr>" + cell(drawing(result, folder)) +
           cell("<b>" + escape_html(result.id) + "</b><br>" + links(result, folder)) + cell(word, style_of(verdict)) +
           number_cell(result, "fitted_rms_mm") + number_cell(result, "fitted_max_mm") +
           number_cell(result, "deviation_rms_mm") + number_cell(result, "time_s") +
           cell(trend_svg(history, result.id, "fitted_rms_mm")) + cell(trend_svg(history, result.id, "time_s")) +
           "</tr><tr><td></td><td colspan=\"8\"><details><summary>" + std::to_string(result.judgement.metrics.size()) +
           " metrics</summary>" + metrics_table(result) + "</details></td></tr>";
}

}  // namespace

std::string suite_page(const SuiteResults& results, const std::vector<HistoryRun>& history, const fs::path& folder) {
    std::vector<const CaseResult*> rows;
    std::size_t passed = 0;
    for (const CaseResult& result : results.cases) {
        rows.push_back(&result);
        passed += result.judgement.verdict <= CaseVerdict::stale;
    }
    std::stable_sort(rows.begin(), rows.end(),
                     [](const auto* a, const auto* b) { return a->judgement.verdict > b->judgement.verdict; });
    const CaseVerdict verdict = verdict_of(results);
    const SuiteFacts& f = results.facts;
    std::string html =
        "<!DOCTYPE html><html lang=\"en\"><meta charset=\"utf-8\"><title>" + escape_html(f.suite) + " suite</title>" +
        kPageStyle + "<h1>" + escape_html(f.suite) + ": <span class=\"" + std::string(style_of(verdict)) + "\">" +
        std::string(kCaseVerdictNames[static_cast<std::size_t>(verdict)]) + "</span></h1><p>" + std::to_string(passed) +
        " of " + std::to_string(rows.size()) + " cases pass. " + escape_html(f.date) + ", commit " +
        escape_html(f.commit) + ", build " + escape_html(f.build.substr(0, 12)) + ", " + escape_html(f.machine) +
        ".</p><p class=\"dim\">Numbers are means over the seeds; below them, grey, those of the "
        "baseline. Trends are of all runs in the history.</p><table><tr><th>part</th><th>case</th>"
        "<th>verdict</th><th class=\"n\">rms, mm</th><th class=\"n\">max, mm</th>"
        "<th class=\"n\">deviation, mm</th><th class=\"n\">time, s</th><th>rms</th><th>time</th></tr>";
    for (const CaseResult* result : rows) {
        html += case_rows(*result, history, folder);
    }
    return html + "</table></html>\n";
}

}  // namespace seampath
