#include "tools/interpolation_seams.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "stages/error.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/place/place.hpp"

namespace seampath {
namespace {

/// Where the flanks of a sample meet, in the section through it.
Eigen::Vector3d meeting_place(const SeamModel& model, const ArcLength& arc, const DeviationSample& sample) {
    const FlankSample flanks = flanks_at(model, sample.station_mm);
    Eigen::Matrix3d planes;
    planes.row(0) = flanks.n1.transpose();
    planes.row(1) = flanks.n2.transpose();
    planes.row(2) = tangent(arc.curve(), arc.parameter(sample.station_mm)).transpose();
    return sample.p + planes.inverse() * Eigen::Vector3d(-sample.flank1_mm, -sample.flank2_mm, 0);
}

SeamTrial trial(const SeamModel& model, const MeasuredSeam& measured) {
    std::vector<double> distance;
    double sum = 0;
    for (const Eigen::Vector3d& p : measured.p) {
        distance.push_back((position(model.curve, nearest_parameter(model.curve, p)) - p).norm());
        sum += distance.back() * distance.back();
    }
    return {std::sqrt(sum / static_cast<double>(distance.size())), quantile(distance, 0.95), quantile(distance, 1)};
}

/// Every method, `parametric` once for each parametrization.
std::vector<SeamMethod> all_methods() {
    std::vector<SeamMethod> methods;
    for (std::size_t m = 0; m < kFitModelNames.size(); ++m) {
        FitOptions options;
        options.model = static_cast<FitModel>(m);
        if (!interpolates(options.model)) {
            continue;
        }
        const std::size_t objectives = options.model == FitModel::parametric ? kFitParametrizationNames.size() : 1;
        for (std::size_t k = 0; k < objectives; ++k) {
            options.parametrization = static_cast<Objective>(k);
            std::string label(name(options.model));
            if (options.model == FitModel::parametric) {
                label += " (" + std::string(kFitParametrizationNames[k]) + ")";
            }
            methods.push_back({label, options, {}, 0});
        }
    }
    return methods;
}

SeamRanking rank(const Seam& seam, const MeasuredSeam& measured, const std::vector<Nodes>& nodes, bool equal) {
    SeamRanking ranking;
    for (const Nodes& n : nodes) {
        ranking.counts.push_back(n.index.size());
    }
    for (SeamMethod& method : all_methods()) {
        if (!equal && sets_nodes(method.options.model)) {
            continue;
        }
        try {
            double log_sum = 0;
            for (const Nodes& n : nodes) {
                SeamModel model = fit(seam, n, method.options);
                method.trials.push_back(trial(model, measured));
                if (method.trials.back().rms_mm < ranking.best.rms_mm) {
                    ranking.best = {method.label + ", " + std::to_string(n.index.size()) + " nodes " +
                                        (equal ? "equally spaced" : "by curvature"),
                                    method.trials.back().rms_mm, std::move(model)};
                }
                log_sum += std::log(std::max(method.trials.back().rms_mm, 1e-9));
            }
            method.mean_rms_mm = std::exp(log_sum / static_cast<double>(nodes.size()));
            ranking.methods.push_back(std::move(method));
        } catch (const InputError& error) {
            ranking.left_out.emplace_back(method.label, error.what());
        }
    }
    std::stable_sort(ranking.methods.begin(), ranking.methods.end(),
                     [](const auto& a, const auto& b) { return a.mean_rms_mm < b.mean_rms_mm; });
    return ranking;
}

}  // namespace

MeasuredSeam measure_seam(const Seam& seam, const Scan& scan, const ValidateOptions& options) {
    MeasuredSeam measured;
    FitOptions smoothing;
    smoothing.model = FitModel::spline;
    measured.spline = fit(seam, {}, smoothing);
    measured.deviation = validate(measured.spline, scan, options);
    const ArcLength arc(measured.spline.curve);
    for (const DeviationSample& sample : measured.deviation.samples) {
        if (sample.covered) {
            measured.p.push_back(meeting_place(measured.spline, arc, sample));
        }
    }
    return measured;
}

Nodes equal_nodes(const Seam& seam, std::size_t count) {
    const std::size_t n = seam.points.size();
    std::vector<double> s{0};
    for (std::size_t i = 1; i < n + (seam.closed ? 1 : 0); ++i) {
        s.push_back(s.back() + (seam.points[i % n].p - seam.points[i - 1].p).norm());
    }
    const std::size_t steps = seam.closed ? count : count - 1;
    Nodes nodes;
    for (std::size_t k = 0; k < count; ++k) {
        const double at = s.back() * static_cast<double>(k) / static_cast<double>(steps);
        const auto above = std::clamp<std::ptrdiff_t>(std::lower_bound(s.begin(), s.end(), at) - s.begin(), 1,
                                                      static_cast<std::ptrdiff_t>(n) - 1);
        const auto i = static_cast<std::size_t>(above);
        const std::size_t nearest = at - s[i - 1] < s[i] - at ? i - 1 : i;
        if (nodes.index.empty() || nearest > nodes.index.back()) {
            nodes.index.push_back(nearest);
        }
    }
    return nodes;
}

Nodes curvature_nodes(const Seam& seam, std::size_t count) {
    constexpr int kBisections = 14;
    constexpr double kSparsest = 3;  // of the equal spacing: also a straight seam needs its direction
    double length = 0;
    for (std::size_t i = 1; i < seam.points.size(); ++i) {
        length += (seam.points[i].p - seam.points[i - 1].p).norm();
    }
    PlaceOptions options;
    options.max_spacing_mm = kSparsest * length / static_cast<double>(count);
    double low = 1e-5, high = length;  // tolerances that take too many nodes, and few enough
    options.chord_tolerance_mm = high;
    Nodes nodes = place(seam, options);
    for (int bisection = 0; bisection < kBisections && nodes.index.size() != count; ++bisection) {
        options.chord_tolerance_mm = std::sqrt(low * high);
        Nodes tried = place(seam, options);
        const bool few = tried.index.size() <= count;
        (few ? high : low) = options.chord_tolerance_mm;
        nodes = few ? std::move(tried) : std::move(nodes);
    }
    return nodes;
}

SeamComparison compare_methods(const Seam& seam, const MeasuredSeam& measured, std::span<const std::size_t> counts) {
    ensure(!counts.empty() && !measured.p.empty(), "there are nodes, and places to hold their lines against");
    SeamComparison comparison;
    comparison.kind = seam.kind;
    comparison.closed = seam.closed;
    comparison.length_mm = measured.spline.length_mm;
    comparison.points = seam.points.size();
    comparison.measured = measured.p.size();
    comparison.spline = trial(measured.spline, measured);
    std::vector<Nodes> equal, curvature;
    std::size_t last = 0;
    for (const std::size_t wanted : counts) {
        const std::size_t count = std::min(wanted, seam.points.size());
        if (count > last) {
            equal.push_back(equal_nodes(seam, count));
            curvature.push_back(curvature_nodes(seam, count));
        }
        last = count;
    }
    comparison.equal = rank(seam, measured, equal, true);
    comparison.curvature = rank(seam, measured, curvature, false);
    const bool equal_is_best = comparison.equal.best.rms_mm <= comparison.curvature.best.rms_mm;
    comparison.best = equal_is_best ? comparison.equal.best : comparison.curvature.best;
    return comparison;
}

}  // namespace seampath
