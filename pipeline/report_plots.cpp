#include "pipeline/report_plots.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "pipeline/groove_columns.hpp"
#include "pipeline/report_checks.hpp"
#include "pipeline/report_inspection.hpp"
#include "pipeline/report_text.hpp"
#include "pipeline/report_torch.hpp"
#include "pipeline/svg.hpp"
#include "stages/geometry/bspline.hpp"

namespace seampath {
namespace {

constexpr double kWide = 1180, kWideHeight = 250, kNarrowPlot = 390, kNarrowHeight = 220;
constexpr double kGap = std::numeric_limits<double>::quiet_NaN();
constexpr int kCurvatureSamples = 600;
constexpr int kBins = 40;

/// Bends wider than 1 m look straight.
constexpr double kLeastCurvature = 1e-3;

/// A tolerance so many times larger than all that was measured would flatten the histogram, or the deviation along the
/// seam; it is then only named.
constexpr double kToleranceInSight = 6, kBandInSight = 12;

std::string figure(const std::string& style, const std::string& caption, const std::string& svg) {
    return "<figure class=\"" + style + "\"><figcaption>" + caption + "</figcaption>" + svg + "</figure>\n";
}

double padded(double most, double least) {
    return 1.12 * std::max(most, least);
}

/// The deviation of every sample; NaN where it was not checked.
struct DeviationLines {
    std::vector<PlotPoint> distance, low, high, flank1, flank2;
    double most = 0;  ///< largest absolute value of all of them, mm
};

DeviationLines deviation_lines(const Deviation& deviation) {
    DeviationLines lines;
    for (const DeviationSample& s : deviation.samples) {
        const double on = s.covered ? 0 : kGap;
        lines.distance.push_back({s.station_mm, s.distance_mm + on});
        lines.low.push_back({s.station_mm, s.distance_mm - s.sigma_mm + on});
        lines.high.push_back({s.station_mm, s.distance_mm + s.sigma_mm + on});
        lines.flank1.push_back({s.station_mm, s.flank1_mm + on});
        lines.flank2.push_back({s.station_mm, s.flank2_mm + on});
        if (s.covered) {
            lines.most =
                std::max({lines.most, s.distance_mm + s.sigma_mm, std::abs(s.flank1_mm), std::abs(s.flank2_mm)});
        }
    }
    return lines;
}

/// Grey boxes over the runs of samples that were not checked against the scan, from one checked sample to the next.
std::string unchecked_boxes(const PlotAxes& axes, const Deviation& deviation) {
    const auto& samples = deviation.samples;
    std::string svg;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const std::size_t first = i;
        while (i < samples.size() && !samples[i].covered) {
            ++i;
        }
        if (i > first) {
            const double from = first > 0 ? samples[first - 1].station_mm : axes.x_low;
            const double to = i < samples.size() ? samples[i].station_mm : axes.x_high;
            svg += svg_box(axes, {from, axes.y_low}, {to, axes.y_high}, "unchecked");
        }
    }
    return svg;
}

/// The worst places, numbered from 1 as in the table of them.
std::string worst_marks(const PlotAxes& axes, const Deviation& deviation, const SeamModel& model) {
    std::vector<PlotPoint> places;
    for (const std::size_t k : worst_samples(deviation, model)) {
        places.push_back({deviation.samples[k].station_mm, deviation.samples[k].distance_mm});
    }
    return svg_numbers(axes, places, "worst");
}

std::string deviation_plot(const Deviation& deviation, const SeamModel& model) {
    const double length_mm = std::max(model.length_mm, 1e-3);
    const DeviationLines lines = deviation_lines(deviation);
    const double tolerance = deviation.tolerance_mm;
    const bool in_sight = tolerance > 0 && tolerance < kBandInSight * lines.most;
    const double reach = padded(in_sight ? std::max(tolerance, lines.most) : lines.most, 1e-4);
    const PlotAxes axes{kWide, kWideHeight, 0, length_mm, -reach, reach, "station along the seam, mm", "deviation, mm"};
    std::string svg = svg_axes(axes, "Deviation of the seam from the scan, along the seam");
    if (in_sight) {
        svg += svg_box(axes, {0, -tolerance}, {length_mm, tolerance}, "inside");
    }
    svg += unchecked_boxes(axes, deviation) + svg_band(axes, lines.low, lines.high, "sigma") +
           svg_line(axes, lines.flank1, "flank1") + svg_line(axes, lines.flank2, "flank2") +
           svg_line(axes, lines.distance, "value") + worst_marks(axes, deviation, model);
    if (in_sight) {
        svg += svg_level(axes, tolerance, "tolerance " + decimal(tolerance, 3) + " mm", "limit") +
               svg_level(axes, -tolerance, "", "limit");
    }
    const std::string beyond =
        in_sight ? "" : ". The tolerance, " + decimal(tolerance, 3) + " mm, lies outside the plot.";
    return figure("wide by-station",
                  "<b>Deviation from the scan</b> <i class=\"value\"></i>distance to the line in which the scanned "
                  "flanks meet, with "
                  "±1σ <i class=\"flank1\"></i>to flank 1 <i class=\"flank2\"></i>to flank 2 (+ outside the material)" +
                      beyond,
                  svg + svg_end());
}

std::string histogram(const Deviation& deviation) {
    std::vector<double> distances;
    for (const DeviationSample& s : deviation.samples) {
        if (s.covered) {
            distances.push_back(s.distance_mm);
        }
    }
    const double tolerance = deviation.tolerance_mm;
    const double most = distances.empty() ? 0 : *std::max_element(distances.begin(), distances.end());
    const bool in_sight = tolerance > 0 && tolerance < kToleranceInSight * most;
    const double reach = padded(in_sight ? std::max(tolerance, most) : most, 1e-4);
    std::vector<double> share(kBins, 0);
    for (const double d : distances) {
        const auto bin = std::min<std::size_t>(kBins - 1, static_cast<std::size_t>(kBins * std::max(0.0, d) / reach));
        share[bin] += 100.0 / static_cast<double>(distances.size());
    }
    const double top = padded(*std::max_element(share.begin(), share.end()), 1);
    const PlotAxes axes{kNarrowPlot, kNarrowHeight, 0, reach, 0, top, "deviation, mm", "share of samples, %"};
    std::string svg = svg_axes(axes, "Histogram of the deviation");
    for (int k = 0; k < kBins; ++k) {
        const double low = reach * k / kBins, high = reach * (k + 1) / kBins;
        svg += svg_box(axes, {low, 0}, {high, share[static_cast<std::size_t>(k)]},
                       low >= tolerance ? "bar beyond" : "bar");
    }
    svg += svg_mark(axes, deviation.p95_mm, "p95", "quantile", 0);
    if (in_sight) {
        svg += svg_mark(axes, tolerance, "tolerance", "limit", 1);
    }
    return figure("", "<b>How often which deviation</b>", svg + svg_end());
}

std::string curvature_plot(const SeamModel& model, const std::vector<Eigen::Vector3d>& nodes) {
    const ArcLength arc(model.curve);
    std::vector<PlotPoint> line, dots;
    double most = 0;
    for (int k = 0; k <= kCurvatureSamples; ++k) {
        const double station = arc.length() * k / kCurvatureSamples;
        line.push_back({station, curvature(model.curve, arc.parameter(station))});
        most = std::max(most, line.back().y);
    }
    for (const Eigen::Vector3d& node : nodes) {
        const double u = nearest_parameter(model.curve, node);
        dots.push_back({arc.station(u), curvature(model.curve, u)});
    }
    const PlotAxes axes{kNarrowPlot,   kNarrowHeight,    0, arc.length(), 0, padded(most, kLeastCurvature),
                        "station, mm", "curvature, 1/mm"};
    return figure("by-station",
                  nodes.empty() ? "<b>Curvature</b>" : "<b>Curvature</b> and the nodes that carry the shape",
                  svg_axes(axes, nodes.empty() ? "Curvature of the seam" : "Curvature of the seam with its nodes") +
                      svg_line(axes, line, "value") + svg_dots(axes, dots, 3, "node") + svg_end());
}

/// How far the seam may be from its model in 19 of 20 cases, over the station; empty where the model does not tell.
std::string band_plot(const SeamModel& model) {
    if (model.band.empty()) {
        return "";
    }
    std::vector<PlotPoint> low, high;
    double most = 0;
    for (const BandSample& sample : model.band) {
        low.push_back({sample.station_mm, -sample.half_width_mm});
        high.push_back({sample.station_mm, sample.half_width_mm});
        most = std::max(most, sample.half_width_mm);
    }
    const double reach = padded(most, 1e-4);
    const PlotAxes axes{kNarrowPlot, kNarrowHeight, 0,           std::max(model.length_mm, 1e-3), -reach,
                        reach,       "station, mm", "across, mm"};
    return figure("", "<b>95 % band</b> of the seam about its model",
                  svg_axes(axes, "Band about the model that holds the seam with 95 %") +
                      svg_band(axes, low, high, "sigma") + svg_end());
}

/// One number of the groove's section over the station, with its band of ±1σ; empty when the scan never shows it.
std::string groove_plot(const Seam& seam, const GrooveColumn& column) {
    const std::vector<Measured> values = groove_values(seam, column);
    std::vector<PlotPoint> line, low, high;
    double station = 0, least = std::numeric_limits<double>::infinity(), most = -least;
    for (std::size_t i = 0; i < values.size(); ++i) {
        station += i > 0 ? (seam.points[i].p - seam.points[i - 1].p).norm() : 0;
        const auto& [value, sigma] = values[i];
        line.push_back({station, value});
        low.push_back({station, value - sigma});
        high.push_back({station, value + sigma});
        if (std::isfinite(value)) {
            least = std::min(least, value - sigma);
            most = std::max(most, value + sigma);
        }
    }
    if (!(most >= least)) {
        return "";
    }
    constexpr double kLeastRange = 0.1;  // of the unit; noise that is far below it should look small
    const double middle = 0.5 * (least + most), half = padded(0.5 * (most - least), 0.5 * kLeastRange);
    const std::string label(column.label), unit(column.shown_unit);
    const PlotAxes axes{kNarrowPlot,   kNarrowHeight,      0, std::max(station, 1e-3), middle - half, middle + half,
                        "station, mm", label + ", " + unit};
    return figure("by-station", "<b>" + label + "</b>, with ±1σ",
                  svg_axes(axes, label + " along the seam") + svg_band(axes, low, high, "sigma") +
                      svg_line(axes, line, "value") + svg_end());
}

std::string groove_plots(const Seam& seam) {
    std::string figures;
    for (const GrooveColumn& column : kGrooveColumns) {
        figures += groove_plot(seam, column);
    }
    return figures;
}

/// Speed between neighbouring weld poses; empty when no torch path was planned for the seam.
std::vector<PlotPoint> torch_speeds(const PartResult& part, std::size_t seam) {
    const auto planned = std::find(part.planned_seams.begin(), part.planned_seams.end(), static_cast<int>(seam));
    if (planned == part.planned_seams.end()) {
        return {};
    }
    const auto number = static_cast<int>(planned - part.planned_seams.begin());
    std::vector<PlotPoint> speeds;
    const Waypoint* before = nullptr;
    for (const Waypoint& w : part.plan.waypoints) {
        const bool welding =
            w.kind == WaypointKind::weld_start || w.kind == WaypointKind::weld || w.kind == WaypointKind::weld_end;
        if (w.seam != number || !welding) {
            continue;
        }
        before = w.kind == WaypointKind::weld_start ? nullptr : before;  // of another pass
        if (before != nullptr && w.time_s > before->time_s) {
            const double speed = (w.p - before->p).norm() / (w.time_s - before->time_s);
            speeds.push_back({before->station_mm, speed});
            speeds.push_back({w.station_mm, speed});
        }
        before = &w;
    }
    return speeds;
}

std::string speed_plot(const PartResult& part, std::size_t seam) {
    const std::vector<PlotPoint> speeds = torch_speeds(part, seam);
    if (speeds.empty()) {
        return figure("", "<b>Torch speed</b> – no torch path was planned for this seam", "");
    }
    const double wanted = part.config.plan.speed_mm_s;
    double most = wanted;
    for (const PlotPoint& p : speeds) {
        most = std::max(most, p.y);
    }
    const std::vector<PlotPoint> planned = planned_speed(part, seam);
    const PlotAxes axes{kNarrowPlot,   kNarrowHeight, 0, part.models[seam].length_mm, 0, padded(most, 1e-3),
                        "station, mm", "speed, mm/s"};
    return figure("by-station",
                  "<b>Torch speed</b> <i class=\"value\"></i>planned <i class=\"flank1\"></i>mean of each move, " +
                      decimal(wanted, 1) + " mm/s asked for",
                  svg_axes(axes, "Torch speed along the seam") + svg_level(axes, wanted, "", "quantile") +
                      svg_line(axes, speeds, "flank1") + svg_line(axes, planned, "value") + svg_end());
}

}  // namespace

std::string seam_plots(const PartResult& part, std::size_t seam) {
    const SeamModel& model = part.models[seam];
    if (part.nominal) {
        return "<div class=\"plots\">\n" + curvature_plot(model, {}) + speed_plot(part, seam) +
               torch_plots(part, seam) + "</div>\n";
    }
    return "<div class=\"plots\">\n" + deviation_plot(part.deviations[seam], model) + section_panel(seam) +
           histogram(part.deviations[seam]) +
           curvature_plot(model, node_positions(part.extraction.seams[seam], part.nodes[seam])) + band_plot(model) +
           speed_plot(part, seam) + torch_plots(part, seam) + groove_plots(part.extraction.seams[seam]) + "</div>\n";
}

}  // namespace seampath
