#include "datasets/regression/compare.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "pipeline/text.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Values before and after, by seed; NaN where there is none.
using Values = std::map<std::uint64_t, std::pair<double, double>>;

/// By case and metric.
using AllValues = std::map<std::pair<std::string, std::string>, Values>;

void take(const SuiteResults& results, bool after, AllValues& all) {
    for (const CaseResult& result : results.cases) {
        for (const CaseRun& run : result.runs) {
            for (const auto& [metric, value] : run.measured.numbers) {
                auto& pair = all[{result.id, metric}].try_emplace(run.seed, std::nan(""), std::nan("")).first->second;
                (after ? pair.second : pair.first) = value;
            }
        }
    }
}

PairedDifference difference_of(const std::string& id, const std::string& metric, const Values& values) {
    PairedDifference d{id, metric, values.size(), 0, 0, 0, 0, 0};
    const auto n = static_cast<double>(values.size());
    double squares = 0;
    for (const auto& [seed, pair] : values) {
        const auto& [before, after] = pair;
        const bool same = before == after || (std::isnan(before) && std::isnan(after));
        d.before += before / n;
        d.after += after / n;
        d.difference += same ? 0 : (after - before) / n;
        squares += same ? 0 : (after - before) * (after - before);
    }
    if (!std::isfinite(d.difference)) {
        d.difference = d.share = kInfinite;
        return d;
    }
    const double variance = n > 1 ? (squares - n * d.difference * d.difference) / (n - 1) : 0;
    d.deviation = std::sqrt(std::max(0.0, variance));
    const double size = std::max(std::abs(d.before), std::abs(d.after));
    const double largest = std::max(std::abs(d.difference), d.deviation);
    d.share = largest > 0 ? (size > 0 ? largest / size : kInfinite) : 0;
    return d;
}

}  // namespace

std::vector<PairedDifference> compare_results(const SuiteResults& before, const SuiteResults& after) {
    AllValues all;
    take(before, false, all);
    take(after, true, all);
    std::vector<PairedDifference> differences;
    for (const auto& [name, values] : all) {
        const PairedDifference d = difference_of(name.first, name.second, values);
        if (d.share > 0) {
            differences.push_back(d);
        }
    }
    std::stable_sort(differences.begin(), differences.end(),
                     [](const auto& a, const auto& b) { return a.share > b.share; });
    return differences;
}

std::string comparison_text(const std::vector<PairedDifference>& differences, std::size_t most) {
    if (differences.empty()) {
        return "no metric of any case differs\n";
    }
    std::vector<std::vector<std::string>> rows{
        {"case", "metric", "seeds", "before", "after", "difference", "sd", "share"}};
    for (const PairedDifference& d : differences) {
        if (rows.size() <= most) {
            rows.push_back({d.id, d.metric, std::to_string(d.seeds), fixed(d.before, 5), fixed(d.after, 5),
                            fixed(d.difference, 5), fixed(d.deviation, 5), fixed(100 * d.share, 1) + " %"});
        }
    }
    const std::size_t left = differences.size() - (rows.size() - 1);
    return aligned(rows) + (left ? "and " + std::to_string(left) + " smaller ones; --all shows them\n" : "");
}

}  // namespace seampath
