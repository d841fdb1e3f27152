#pragma once

#include <optional>
#include <string>
#include <vector>

#include "datasets/regression/baseline.hpp"

/// Whether what came out of a case is as good as what was accepted.
namespace seampath {

/// From good to bad. `better` than its band: the baseline is stale. `fresh`: there is no golden value. `worse` than its
/// band: a regression.
enum class MetricVerdict { same, better, fresh, worse };
inline constexpr std::array<std::string_view, 4> kMetricVerdictNames{"same", "better", "no baseline", "worse"};

/// One metric over all seeds of a case. Of a hash only the verdict says something.
struct MetricChange {
    std::string name;
    MetricVerdict verdict = MetricVerdict::same;
    Severity severity = Severity::fail;
    double golden = 0;      ///< mean over the seeds
    double now = 0;         ///< mean over the seeds
    double difference = 0;  ///< mean of now - golden, seed by seed
    double allowed = 0;     ///< most that the mean may change for the worse
    std::string why;        ///< where it is not the same: one sentence with the numbers
};

/// From good to bad; what a suite ends with is the worst of its cases.
enum class CaseVerdict { pass, stale, no_baseline, regression, no_data, failed };
inline constexpr std::array<std::string_view, 6> kCaseVerdictNames{
    "pass", "stale baseline", "no baseline", "regression", "data missing or wrong", "crash, time or memory"};

struct CaseJudgement {
    CaseVerdict verdict = CaseVerdict::pass;
    std::vector<MetricChange> metrics;  ///< in the order of the measurements
    std::vector<std::string> reasons;   ///< behind a verdict that is not pass, and notes; one sentence each
};

/// Judges the runs of one case, one a seed, by paired differences. With differences d of n seeds (now less golden, in
/// the direction that is worse), the mean of d may be as large as
///     max(absolute, relative |mean golden|, 3 s),  s = sd(d) / sqrt(n), the standard error of that mean;
/// and a single seed's, since one seed gone wrong widens s by itself, as
///     max(absolute, relative |golden|, 3 S),  S = sd(golden) over the seeds.
/// The same distance in the direction that is better makes a baseline stale. A number that is not finite is the same
/// only as one like it. A metric that the baseline has and the run has not is worse; one that only the run has has no
/// baseline. So has a case with metrics but without `baseline`; a refusal has none and needs none.
CaseJudgement judge(const SuiteCase& entry, const std::vector<CaseRun>& runs, const std::optional<Baseline>& baseline);

}  // namespace seampath
