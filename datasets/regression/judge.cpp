#include "datasets/regression/judge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "stages/text.hpp"

namespace seampath {
namespace {

/// The golden and the new value of one metric with one seed.
struct Pair {
    std::uint64_t seed;
    double golden, now;

    /// For the worse above 0; infinite where only one of both is a number.
    double worsening(Better better) const {
        const bool same = golden == now || (std::isnan(golden) && std::isnan(now));
        const double d = same ? 0 : now - golden;
        if (!std::isfinite(d)) {
            return std::numeric_limits<double>::infinity();
        }
        return better == Better::both ? std::abs(d) : better == Better::lower ? d : -d;
    }
};

double mean_of(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Standard deviation; 0 of a single value.
double deviation_of(const std::vector<double>& values) {
    if (values.size() < 2) {
        return 0;
    }
    const double mean = mean_of(values);
    double squares = 0;
    for (const double v : values) {
        squares += (v - mean) * (v - mean);
    }
    return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

std::string sentence(const MetricChange& change, const std::string& more) {
    return change.name + " " + shortest(change.golden) + " -> " + shortest(change.now) + ": " + more;
}

/// `pairs` are not empty.
MetricChange judge_metric(const std::string& name, const Band& band, const std::vector<Pair>& pairs) {
    std::vector<double> golden, now, difference, worsening;
    for (const Pair& pair : pairs) {
        golden.push_back(pair.golden);
        now.push_back(pair.now);
        difference.push_back(pair.now - pair.golden);
        worsening.push_back(pair.worsening(band.better));
    }
    MetricChange change{name, MetricVerdict::same, band.severity, mean_of(golden), mean_of(now), mean_of(difference), 0,
                        {}};
    const double error_of_mean = deviation_of(difference) / std::sqrt(static_cast<double>(pairs.size()));
    const double band_of_mean = std::max(band.absolute, band.relative * std::abs(change.golden));
    change.allowed = std::max(band_of_mean, std::isfinite(error_of_mean) ? 3 * error_of_mean : 0);
    const double spread = deviation_of(golden);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const double allowed =
            std::max({band.absolute, band.relative * std::abs(golden[i]), std::isfinite(spread) ? 3 * spread : 0});
        if (!(worsening[i] <= allowed)) {
            change.verdict = MetricVerdict::worse;
            change.why =
                sentence(change, "seed " + std::to_string(pairs[i].seed) + " went from " + shortest(golden[i]) +
                                     " to " + shortest(now[i]) + ", allowed are " + shortest(allowed));
        }
    }
    // Directions cancel in a mean of absolute values, so that of `both` is the absolute value of the mean.
    const double mean = band.better == Better::both && std::isfinite(change.difference) ? std::abs(change.difference)
                                                                                        : mean_of(worsening);
    if (!(mean <= change.allowed)) {
        change.verdict = MetricVerdict::worse;
        change.why = sentence(change, "the mean over the seeds went by " + shortest(change.difference) +
                                          ", allowed are " + shortest(change.allowed));
    } else if (change.verdict == MetricVerdict::same && band.better != Better::both && -mean > change.allowed) {
        change.verdict = MetricVerdict::better;
        change.why = sentence(change, "better than the band of " + shortest(change.allowed));
    }
    return change;
}

template <class Value>
const Value* value_of(const std::vector<std::pair<std::string, Value>>& list, const std::string& name) {
    const auto found = std::find_if(list.begin(), list.end(), [&](const auto& pair) { return pair.first == name; });
    return found == list.end() ? nullptr : &found->second;
}

/// Every name in the runs and the golden values, those of the runs first.
template <class Value>
std::vector<std::string> names_in(const std::vector<CaseRun>& runs, const Baseline& baseline,
                                  std::vector<std::pair<std::string, Value>> Measurements::*list) {
    std::vector<std::string> names;
    const auto add = [&](const Measurements& measured) {
        for (const auto& [name, value] : measured.*list) {
            if (std::find(names.begin(), names.end(), name) == names.end()) {
                names.push_back(name);
            }
        }
    };
    for (const CaseRun& run : runs) {
        add(run.measured);
    }
    for (const auto& [seed, golden] : baseline.seeds) {
        add(golden.measured);
    }
    return names;
}

MetricChange worse(const std::string& name, const Band& band, const std::string& why) {
    return {name, MetricVerdict::worse, band.severity, 0, 0, 0, 0, name + " " + why};
}

/// Of numbers or hashes; the latter are the same or not.
template <class Value>
void judge_list(const SuiteCase& entry, const std::vector<CaseRun>& runs, const Baseline& baseline,
                std::vector<std::pair<std::string, Value>> Measurements::*list, CaseJudgement& judgement) {
    for (const std::string& name : names_in(runs, baseline, list)) {
        const Band* band = band_of(entry, name);
        if (!band) {
            continue;
        }
        std::vector<Pair> pairs;
        MetricChange change{name, MetricVerdict::same, band->severity, 0, 0, 0, 0, {}};
        for (const CaseRun& run : runs) {
            const auto golden_run = baseline.seeds.find(run.seed);
            const Value* golden =
                golden_run == baseline.seeds.end() ? nullptr : value_of(golden_run->second.measured.*list, name);
            const Value* now = value_of(run.measured.*list, name);
            const std::string seed = "of seed " + std::to_string(run.seed);
            if (golden && !now) {
                change = worse(name, *band, seed + " is missing; the baseline has it");
            } else if (now && !golden && change.verdict != MetricVerdict::worse) {
                change.verdict = MetricVerdict::fresh;
                change.why = name + " " + seed + " has no golden value";
            } else if constexpr (std::is_same_v<Value, double>) {
                if (now && golden) {
                    pairs.push_back({run.seed, *golden, *now});
                }
            } else if (now && golden && *now != *golden) {
                change = worse(name, *band, seed + " is another one");
            }
        }
        const bool complete = change.verdict == MetricVerdict::same && !pairs.empty();
        judgement.metrics.push_back(complete ? judge_metric(name, *band, pairs) : change);
    }
}

void raise(CaseJudgement& judgement, CaseVerdict verdict, const std::string& reason) {
    judgement.verdict = std::max(judgement.verdict, verdict);
    judgement.reasons.push_back(reason);
}

/// Runs that did not end, and outcomes that were not expected.
void judge_outcomes(const SuiteCase& entry, const std::vector<CaseRun>& runs, const Baseline& baseline,
                    CaseJudgement& judgement) {
    for (const CaseRun& run : runs) {
        const std::string seed = "seed " + std::to_string(run.seed) + ": ";
        if (run.status != RunStatus::done) {
            raise(judgement, run.status == RunStatus::data ? CaseVerdict::no_data : CaseVerdict::failed,
                  seed + run.message);
            continue;
        }
        const auto golden = baseline.seeds.find(run.seed);
        const bool recorded = entry.expect == Expectation::recorded;
        if (recorded && golden == baseline.seeds.end()) {
            raise(judgement, CaseVerdict::no_baseline, seed + "no outcome is recorded");
            continue;
        }
        const std::string expected =
            recorded ? golden->second.outcome : std::string(kExpectationNames[static_cast<std::size_t>(entry.expect)]);
        const std::string said = run.outcome + (run.message.empty() ? "" : ": " + run.message);
        if (run.outcome != expected) {
            raise(judgement, CaseVerdict::regression, seed + "expected was \"" + expected + "\"; this came: " + said);
        } else if (run.message.find(entry.reason) == std::string::npos) {
            raise(judgement, CaseVerdict::regression,
                  seed + "refused for another reason than \"" + entry.reason + "\": " + run.message);
        }
    }
}

}  // namespace

CaseJudgement judge(const SuiteCase& entry, const std::vector<CaseRun>& runs, const std::optional<Baseline>& baseline) {
    const Baseline golden = baseline.value_or(Baseline{});
    CaseJudgement judgement;
    judge_outcomes(entry, runs, golden, judgement);
    if (judgement.verdict >= CaseVerdict::no_data) {
        return judgement;
    }
    judge_list(entry, runs, golden, &Measurements::numbers, judgement);
    judge_list(entry, runs, golden, &Measurements::hashes, judgement);
    for (const MetricChange& change : judgement.metrics) {
        if (change.verdict == MetricVerdict::worse && change.severity == Severity::fail) {
            raise(judgement, CaseVerdict::regression, change.why);
        } else if (change.verdict == MetricVerdict::fresh && baseline) {
            raise(judgement, CaseVerdict::no_baseline, change.why);
        } else if (change.verdict == MetricVerdict::better && change.severity == Severity::fail) {
            raise(judgement, CaseVerdict::stale, "stale baseline: " + change.why);
        } else if (change.verdict == MetricVerdict::worse) {
            judgement.reasons.push_back("note: " + change.why);
        }
    }
    if (!baseline && !judgement.metrics.empty()) {
        raise(judgement, CaseVerdict::no_baseline, "there is no baseline; look at the results, then accept them");
    }
    return judgement;
}

}  // namespace seampath
