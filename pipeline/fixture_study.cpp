#include "pipeline/fixture_study.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Values = std::vector<std::vector<std::vector<double>>>;

constexpr double kIndividuals = 2.66;  // 3 / d2 of moving ranges of two, d2 = 1.128
constexpr double kDriftSigmas = 3;
constexpr std::size_t kFewestForDrift = 5;

double mean_of(const std::vector<double>& v) {
    double sum = 0;
    for (const double x : v) {
        sum += x;
    }
    return sum / static_cast<double>(v.size());
}

double root(double variance) {
    return std::sqrt(std::max(0.0, variance));
}

/// Mean squares of the two-way layout with repetition.
struct MeanSquares {
    double part = 0, appraiser = 0, interaction = 0, error = 0;
    double pooled = 0;  ///< interaction and error together
};

MeanSquares mean_squares(const Values& value) {
    const double p = static_cast<double>(value.size()), a = static_cast<double>(value[0].size()),
                 t = static_cast<double>(value[0][0].size());
    std::vector<double> by_part(value.size(), 0), by_appraiser(value[0].size(), 0);
    double all = 0, error = 0, interaction = 0;
    for (std::size_t i = 0; i < value.size(); ++i) {
        for (std::size_t k = 0; k < value[i].size(); ++k) {
            const double mean = mean_of(value[i][k]);
            by_part[i] += mean / a;
            by_appraiser[k] += mean / p;
            all += mean / (p * a);
            for (const double x : value[i][k]) {
                error += (x - mean) * (x - mean);
            }
        }
    }
    for (std::size_t i = 0; i < value.size(); ++i) {
        for (std::size_t k = 0; k < value[i].size(); ++k) {
            const double d = mean_of(value[i][k]) - by_part[i] - by_appraiser[k] + all;
            interaction += t * d * d;
        }
    }
    MeanSquares ms;
    for (const double mean : by_part) {
        ms.part += a * t * (mean - all) * (mean - all) / std::max(1.0, p - 1);
    }
    for (const double mean : by_appraiser) {
        ms.appraiser += p * t * (mean - all) * (mean - all) / std::max(1.0, a - 1);
    }
    ms.error = error / (p * a * (t - 1));
    ms.interaction = interaction / std::max(1.0, (p - 1) * (a - 1));
    ms.pooled = (error + interaction) / (p * a * (t - 1) + (p - 1) * (a - 1));
    return ms;
}

DriftChart chart_of(const std::string& name, const std::vector<double>& x) {
    DriftChart chart;
    chart.name = name;
    chart.mean = mean_of(x);
    double range = 0, sxy = 0, sxx = 0, rest = 0;
    const double n = static_cast<double>(x.size()), middle = (n - 1) / 2;
    for (std::size_t i = 0; i < x.size(); ++i) {
        chart.value.push_back(x[i] - chart.mean);
        range += i > 0 ? std::abs(x[i] - x[i - 1]) / (n - 1) : 0;
        sxy += (static_cast<double>(i) - middle) * chart.value[i];
        sxx += (static_cast<double>(i) - middle) * (static_cast<double>(i) - middle);
    }
    chart.limit = kIndividuals * range;
    chart.slope = sxy / sxx;
    for (std::size_t i = 0; i < x.size(); ++i) {
        const double d = chart.value[i] - chart.slope * (static_cast<double>(i) - middle);
        rest += d * d;
        if (std::abs(chart.value[i]) > chart.limit) {
            chart.out.push_back(i);
        }
    }
    const double error = n > 2 ? std::sqrt(rest / (n - 2) / sxx) : 0;
    chart.slope_sigmas = error > 0 ? std::abs(chart.slope) / error : 0;
    return chart;
}

/// The coordinate of each run, from the mean of its own part where there are several: parts differ, and that is no
/// drift.
std::vector<double> coordinate(const std::vector<HistoryRow>& runs, const WorkPoint& w, int axis, bool from_part_mean) {
    std::map<std::string, std::vector<double>> of_part;
    std::vector<double> x;
    for (const HistoryRow& run : runs) {
        x.push_back((run.base_from_part * w.p)[axis]);
        of_part[run.part].push_back(x.back());
    }
    for (std::size_t i = 0; from_part_mean && of_part.size() > 1 && i < x.size(); ++i) {
        x[i] -= mean_of(of_part[runs[i].part]);
    }
    return x;
}

/// Between the first run and the last of a part, the largest of all parts.
double largest_shift(const std::vector<HistoryRow>& runs, const WorkPoint& w) {
    std::map<std::string, Eigen::Vector3d> first;
    std::map<std::string, double> shift;
    for (const HistoryRow& run : runs) {
        const Eigen::Vector3d p = run.base_from_part * w.p;
        shift[run.part] = (p - first.emplace(run.part, p).first->second).norm();
    }
    double largest = 0;
    for (const auto& [part, distance] : shift) {
        largest = std::max(largest, distance);
    }
    return largest;
}

/// The coordinate's values by part and appraiser; empty when the sets are not complete and of one size.
Values by_part_and_appraiser(const std::vector<HistoryRow>& runs, const std::vector<double>& x) {
    std::set<std::string> parts, appraisers;
    std::map<std::pair<std::string, std::string>, std::vector<double>> cell;
    for (std::size_t i = 0; i < runs.size(); ++i) {
        parts.insert(runs[i].part);
        appraisers.insert(runs[i].appraiser);
        cell[{runs[i].part, runs[i].appraiser}].push_back(x[i]);
    }
    Values value;
    const std::size_t trials = cell.begin()->second.size();
    for (const auto& part : parts) {
        value.emplace_back();
        for (const auto& appraiser : appraisers) {
            const auto found = cell.find({part, appraiser});
            if (found == cell.end() || found->second.size() != trials || trials < 2) {
                return {};
            }
            value.back().push_back(found->second);
        }
    }
    return value;
}

}  // namespace

// Components of variance from the expected mean squares. The interaction is pooled with the error when it is not
// significant (F below 2, about its 95 % point for the usual 10 x 3 x 3 study), as AIAG's does at 0.25.
GaugeStudy gauge_study(const Values& value, double tolerance) {
    if (value.empty() || value[0].empty() || value[0][0].size() < 2) {
        throw InputError("study: less than two trials of the same part; repeat the calibration");
    }
    GaugeStudy g;
    g.parts = static_cast<int>(value.size());
    g.appraisers = static_cast<int>(value[0].size());
    g.trials = static_cast<int>(value[0][0].size());
    const MeanSquares ms = mean_squares(value);
    const double p = g.parts, a = g.appraisers, t = g.trials;
    const bool interacts = g.parts > 1 && g.appraisers > 1 && ms.interaction > 2 * ms.error;
    const double error = interacts ? ms.error : ms.pooled, under = interacts ? ms.interaction : ms.pooled;
    const double interaction = interacts ? (ms.interaction - ms.error) / t : 0;
    const double appraiser = g.appraisers > 1 ? std::max(0.0, (ms.appraiser - under) / (p * t)) : 0;
    g.repeatability = root(error);
    g.reproducibility = root(appraiser + interaction);
    g.part_variation = g.parts > 1 ? root((ms.part - under) / (a * t)) : 0;
    g.gauge = std::hypot(g.repeatability, g.reproducibility);
    g.percent_of_tolerance = 100 * 6 * g.gauge / tolerance;
    g.distinct_categories = g.gauge > 0 ? 1.41 * g.part_variation / g.gauge : 0;
    return g;
}

FixtureStudy study_fixture(const std::vector<HistoryRow>& runs, double limit_mm) {
    if (runs.size() < 2) {
        throw InputError("study: " + std::to_string(runs.size()) +
                         " calibrations; two or more of the same fixture were needed");
    }
    FixtureStudy study;
    study.runs = runs.size();
    for (const WorkPoint& w : runs.back().work_points) {
        const double shift = largest_shift(runs, w);
        study.largest_shift_mm = std::max(study.largest_shift_mm, shift);
        if (shift > limit_mm) {
            study.alarms.push_back("work point " + w.name + " has moved by " + fixed(shift, 3) +
                                   " mm from the first run "
                                   "to the last; the limit is " +
                                   shortest(limit_mm) + " mm");
        }
        for (int axis = 0; axis < 3; ++axis) {
            const std::string name = w.name + ", " + "xyz"[axis];
            study.charts.push_back(chart_of(name, coordinate(runs, w, axis, true)));
            const DriftChart& chart = study.charts.back();
            if (!chart.out.empty() && runs.size() >= kFewestForDrift) {
                study.alarms.push_back(name + ": run " + std::to_string(chart.out.front() + 1) + " is " +
                                       fixed(std::abs(chart.value[chart.out.front()]), 4) +
                                       " mm off the mean; the control limit is " + fixed(chart.limit, 4) + " mm");
            }
            if (chart.slope_sigmas > kDriftSigmas && runs.size() >= kFewestForDrift) {
                study.alarms.push_back(name + " drifts by " + fixed(chart.slope, 5) + " mm a run (" +
                                       fixed(chart.slope_sigmas, 1) + " sigma)");
            }
            const std::vector<double> x = coordinate(runs, w, axis, false);
            Values value = by_part_and_appraiser(runs, x);
            if (value.empty()) {
                value = {{x}};
            }
            const GaugeStudy gauge = gauge_study(value, 2 * limit_mm);
            if (!study.gauge || gauge.gauge > study.gauge->gauge) {
                study.gauge = gauge;
                study.gauge_of = name;
            }
        }
    }
    if (study.gauge && study.gauge->parts == 1 && study.gauge->appraisers == 1) {
        study.notes.emplace_back(
            "one part and one appraiser, or not as many runs of each: all runs count as repeated "
            "trials; --part and --appraiser tell them apart");
    }
    if (study.gauge && study.gauge->percent_of_tolerance > 30) {
        study.alarms.push_back("GRR takes " + fixed(study.gauge->percent_of_tolerance, 1) + " % of the tolerance (" +
                               study.gauge_of + "); above 30 % it is no gauge for it");
    }
    return study;
}

}  // namespace seampath
