#include <algorithm>
#include <array>
#include <cmath>

#include <nlohmann/json.hpp>

#include "pipeline/report_text.hpp"
#include "pipeline/svg.hpp"
#include "pipeline/text.hpp"
#include "stages/text.hpp"
#include "tools/interpolation.hpp"
#include "tools/interpolation_seams.hpp"

namespace seampath {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kDecimals = 4;

// CSS pixels.
constexpr double kWidth = 420, kHeight = 300, kLegend = 200, kLine = 15, kGap = 20;

std::string ranking_text(const std::string& title, const SeamRanking& ranking) {
    std::vector<std::vector<std::string>> rows{{"", title}};
    for (const std::size_t count : ranking.counts) {
        rows[0].push_back(std::to_string(count) + ": rms");
        rows[0].insert(rows[0].end(), {"p95", "max"});
    }
    for (const SeamMethod& method : ranking.methods) {
        rows.push_back({std::to_string(rows.size()), method.label});
        for (const SeamTrial& trial : method.trials) {
            rows.back().insert(rows.back().end(), {fixed(trial.rms_mm, kDecimals), fixed(trial.p95_mm, kDecimals),
                                                   fixed(trial.max_mm, kDecimals)});
        }
    }
    return aligned(rows);
}

Json trial_json(const SeamTrial& trial) {
    return {{"rms_mm", trial.rms_mm}, {"p95_mm", trial.p95_mm}, {"max_mm", trial.max_mm}};
}

Json ranking_json(const SeamRanking& ranking) {
    Json methods = Json::array(), left_out = Json::array();
    for (const SeamMethod& method : ranking.methods) {
        Json trials = Json::array();
        for (const SeamTrial& trial : method.trials) {
            trials.push_back(trial_json(trial));
        }
        methods.push_back({{"method", method.label}, {"mean_rms_mm", method.mean_rms_mm}, {"trials", trials}});
    }
    for (const auto& [label, reason] : ranking.left_out) {
        left_out.push_back({{"method", label}, {"reason", reason}});
    }
    return {{"nodes", ranking.counts}, {"methods", methods}, {"left_out", left_out}};
}

double log_rms(double rms_mm) {
    return std::log10(std::max(rms_mm, 1e-9));
}

/// All labels, so that a method has one colour in all plots.
std::vector<std::string> labels(std::span<const SeamComparison> comparisons) {
    std::vector<std::string> all;
    for (const SeamComparison& comparison : comparisons) {
        for (const SeamRanking* ranking : {&comparison.equal, &comparison.curvature}) {
            for (const SeamMethod& method : ranking->methods) {
                if (std::find(all.begin(), all.end(), method.label) == all.end()) {
                    all.push_back(method.label);
                }
            }
        }
    }
    return all;
}

PlotAxes axes_of(std::span<const SeamComparison> comparisons) {
    PlotAxes axes{kWidth, kHeight, 1e9, 0, 1e9, -1e9, "", "rms distance, lg of mm"};
    for (const SeamComparison& comparison : comparisons) {
        axes.y_low = std::min(axes.y_low, log_rms(comparison.spline.rms_mm));
        for (const SeamRanking* ranking : {&comparison.equal, &comparison.curvature}) {
            for (const std::size_t count : ranking->counts) {
                axes.x_low = std::min(axes.x_low, static_cast<double>(count) - 1);
                axes.x_high = std::max(axes.x_high, static_cast<double>(count) + 1);
            }
            for (const SeamMethod& method : ranking->methods) {
                for (const SeamTrial& trial : method.trials) {
                    axes.y_low = std::min(axes.y_low, log_rms(trial.rms_mm));
                    axes.y_high = std::max(axes.y_high, log_rms(trial.rms_mm));
                }
            }
        }
    }
    axes.y_low -= 0.1;
    axes.y_high = std::max(axes.y_high, axes.y_low) + 0.1;
    return axes;
}

std::string plot(const SeamRanking& ranking, const SeamComparison& comparison, PlotAxes axes, const std::string& title,
                 const std::vector<std::string>& all, double x, double y) {
    axes.x_label = title;
    std::string svg = svg_axes(axes, title);
    svg.insert(4, " x=\"" + decimal(x, 0) + "\" y=\"" + decimal(y, 0) + "\" width=\"" + decimal(kWidth, 0) +
                      "\" height=\"" + decimal(kHeight, 0) + "\"");  // after "<svg"
    svg += svg_level(axes, log_rms(comparison.spline.rms_mm), "spline", "spline");
    for (const SeamMethod& method : ranking.methods) {
        const auto i = static_cast<std::size_t>(std::find(all.begin(), all.end(), method.label) - all.begin());
        std::vector<PlotPoint> points;
        for (std::size_t k = 0; k < method.trials.size(); ++k) {
            points.push_back({static_cast<double>(ranking.counts[k]), log_rms(method.trials[k].rms_mm)});
        }
        svg += svg_line(axes, points, line_class(i)) + svg_dots(axes, points, 2, "node");
    }
    return svg + svg_end();
}

}  // namespace

std::string seam_comparison_text(const SeamComparison& comparison) {
    std::string left_out;  // the same for both rankings
    for (const auto& [label, reason] : comparison.equal.left_out) {
        left_out += "left out: " + label + ": " + reason + "\n";
    }
    return std::string(name(comparison.kind)) + (comparison.closed ? ", closed, " : ", open, ") +
           fixed(comparison.length_mm, 2) + " mm, " + std::to_string(comparison.points) + " points; distances of " +
           std::to_string(comparison.measured) +
           " places measured in the raw scan, mm\nspline through all points: rms " +
           fixed(comparison.spline.rms_mm, kDecimals) + ", p95 " + fixed(comparison.spline.p95_mm, kDecimals) +
           ", max " + fixed(comparison.spline.max_mm, kDecimals) + "\n\n" +
           ranking_text("nodes equally spaced", comparison.equal) + "\n" +
           ranking_text("nodes by curvature", comparison.curvature) + left_out;
}

Json seam_comparison_json(const SeamComparison& comparison) {
    return {{"kind", name(comparison.kind)},           {"closed", comparison.closed},
            {"length_mm", comparison.length_mm},       {"points", comparison.points},
            {"measured", comparison.measured},         {"spline", trial_json(comparison.spline)},
            {"equal", ranking_json(comparison.equal)}, {"curvature", ranking_json(comparison.curvature)}};
}

std::string seam_comparisons_svg(std::span<const SeamComparison> comparisons) {
    const std::vector<std::string> all = labels(comparisons);
    const PlotAxes axes = axes_of(comparisons);
    std::string plots;
    double y = 0;
    for (std::size_t i = 0; i < comparisons.size(); ++i, y += kHeight + kGap) {
        const std::string seam = "seam " + std::to_string(i) + ", ";
        plots += plot(comparisons[i].equal, comparisons[i], axes, seam + "nodes equally spaced", all, 0, y);
        plots +=
            plot(comparisons[i].curvature, comparisons[i], axes, seam + "nodes by curvature", all, kWidth + kGap, y);
    }
    const double left = 2 * (kWidth + kGap), height = std::max(y, kLine * static_cast<double>(all.size() + 2));
    return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + decimal(left + kLegend, 0) + ' ' +
           decimal(height, 0) + "\">" + line_style(all.size()) +
           "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>" + plots + line_legend(all, left, kLine) + svg_end();
}

}  // namespace seampath
