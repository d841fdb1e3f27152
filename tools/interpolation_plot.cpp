#include <algorithm>
#include <array>

#include "pipeline/report_text.hpp"
#include "pipeline/svg.hpp"
#include "tools/interpolation.hpp"

namespace seampath {
namespace {

// Told apart by people with any kind of colour vision (Paul Tol's muted and vibrant schemes).
constexpr std::array<const char*, 10> kColours{"#332288", "#cc3311", "#117733", "#ee7733", "#0077bb",
                                               "#882255", "#44aa99", "#999933", "#cc6677", "#bbbbbb"};

// CSS pixels.
constexpr double kPlotWidth = 760, kPlotHeight = 480, kPlotLegend = 190, kPlotLine = 18;

/// The nodes and check points with some room; lines that swing farther are cut at the edge.
PlotAxes axes(const Comparison& comparison) {
    auto [low, high] = std::minmax_element(comparison.y.begin(), comparison.y.end());
    double bottom = *low, top = *high;
    for (const auto& point : comparison.checks) {
        bottom = std::min(bottom, point.y());
        top = std::max(top, point.y());
    }
    const double room = top > bottom ? 0.15 * (top - bottom) : 1;
    return {kPlotWidth,    kPlotHeight, comparison.x.front(), comparison.x.back(),
            bottom - room, top + room,  comparison.x_name,    comparison.y_name};
}

std::vector<PlotPoint> samples(const Interpolant& line) {
    constexpr int kSamples = 40;
    std::vector<PlotPoint> points;
    for (std::size_t i = 0; i + 1 < line.t.size(); ++i) {
        for (int k = 0; k < kSamples; ++k) {
            const Eigen::Vector2d p = line.at(line.t[i] + (line.t[i + 1] - line.t[i]) * k / kSamples);
            points.push_back({p.x(), p.y()});
        }
    }
    const Eigen::Vector2d last = line.at(line.t.back());
    points.push_back({last.x(), last.y()});
    return points;
}

}  // namespace

std::string line_class(std::size_t i) {
    return "line" + std::to_string(i);
}

/// Colours come again with dashes.
std::string line_style(std::size_t lines) {
    std::string css =
        "text { font: 11px sans-serif; fill: #5b6775; } .grid { stroke: #edf0f3; } .axis { stroke: #8b95a0; } "
        ".middle { text-anchor: middle; } .end { text-anchor: end; } path { fill: none; stroke-width: 1.4; } "
        ".node { fill: #fff; stroke: #1c2530; } .check { fill: #1c2530; } .spline { stroke: #1c2530; }";
    for (std::size_t i = 0; i < lines; ++i) {
        const char* dashes = i < kColours.size() ? "" : "; stroke-dasharray: 5 3";
        css.append(" .").append(line_class(i)).append(" { stroke: ").append(kColours[i % kColours.size()]);
        css.append(dashes).append("; }");
    }
    return "<style>" + css + "</style>";
}

std::string line_legend(const std::vector<std::string>& labels, double left_px, double line_px) {
    std::string svg;
    for (std::size_t i = 0; i < labels.size(); ++i) {
        const std::string y = decimal(20 + line_px * static_cast<double>(i), 1);
        svg.append("<path class=\"").append(line_class(i)).append("\" d=\"M").append(decimal(left_px + 8, 1));
        svg.append(" ").append(y).append("h24\"/><text x=\"").append(decimal(left_px + 40, 1)).append("\" y=\"");
        svg.append(y).append("\" dy=\"4\">").append(escape_html(labels[i])).append("</text>");
    }
    return svg;
}

std::string comparison_svg(const Comparison& comparison) {
    const PlotAxes frame = axes(comparison);
    const double height = std::max(kPlotHeight, 20 + kPlotLine * static_cast<double>(comparison.results.size()));
    std::string plot = svg_axes(frame, "Interpolation of a table by several methods");
    plot.insert(
        4, " width=\"" + decimal(kPlotWidth, 0) + "\" height=\"" + decimal(kPlotHeight, 0) + "\"");  // after "<svg"
    std::vector<std::string> labels;
    for (std::size_t i = 0; i < comparison.results.size(); ++i) {
        labels.push_back(comparison.results[i].label);
        plot += svg_line(frame, samples(comparison.results[i].line), line_class(i));
    }
    std::vector<PlotPoint> nodes, checks;
    for (std::size_t i = 0; i < comparison.x.size(); ++i) {
        nodes.push_back({comparison.x[i], comparison.y[i]});
    }
    for (const auto& point : comparison.checks) {
        checks.push_back({point.x(), point.y()});
    }
    plot += svg_dots(frame, nodes, 3.5, "node") + svg_dots(frame, checks, 2, "check") + svg_end();
    return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + decimal(kPlotWidth + kPlotLegend, 0) + ' ' +
           decimal(height, 0) + "\">" + line_style(labels.size()) +
           "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>" + plot + line_legend(labels, kPlotWidth, kPlotLine) +
           svg_end();
}

}  // namespace seampath
