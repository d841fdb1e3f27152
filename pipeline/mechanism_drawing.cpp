#include "pipeline/mechanism_drawing.hpp"

#include <algorithm>
#include <iterator>
#include <numbers>
#include <vector>

#include "pipeline/svg.hpp"

namespace seampath {
namespace {

constexpr std::string_view kStyle =
    "svg{background:#fff;font:12px sans-serif}"
    "line.grid{stroke:none}line.axis{stroke:#7d8794}.tick,.label{fill:#4a5560}.middle{text-anchor:middle}"
    ".end{text-anchor:end}path{fill:none}.lines{stroke:#c3cad2;stroke-width:.7}.wanted{stroke:#176b3a;stroke-width:1.6}"
    ".way{stroke:#c2571a;stroke-width:1.6}.node{fill:#c2571a}";

// Size of the drawing, with room for the axes so that both have the same scale; points of a drawn arc and circle; most
// lines of each kind; more nodes than this are drawn as the line alone.
constexpr double kWidth = 772, kHeight = 750;
constexpr int kArcPoints = 24, kCirclePoints = 180, kMostArcs = 72, kMostCircles = 24;
constexpr std::size_t kMostDots = 400;
constexpr double kMargin = 1.04;

PlotPoint plot(const Eigen::Vector2d& p) {
    return {p.x(), p.y()};
}

std::string grid_lines(const PlotAxes& axes, const TwoTierGrid& grid) {
    std::string svg;
    const int each_circle = (grid.beta_steps + kMostCircles - 1) / kMostCircles;
    for (int j = each_circle; j <= grid.beta_steps; j += each_circle) {
        std::vector<PlotPoint> circle;
        const double beta = std::numbers::pi / 3 * j / grid.beta_steps;
        for (int k = 0; k <= kCirclePoints; ++k) {
            circle.push_back(plot(tool_position(grid.radius_mm, {2 * std::numbers::pi * k / kCirclePoints, beta})));
        }
        svg += svg_line(axes, circle, "lines");
    }
    const int each_arc = (grid.alpha_steps + kMostArcs - 1) / kMostArcs;
    for (int i = 0; i < grid.alpha_steps; i += each_arc) {
        std::vector<PlotPoint> arc;
        const double alpha = 2 * std::numbers::pi * i / grid.alpha_steps;
        for (int k = 0; k <= kArcPoints; ++k) {
            arc.push_back(plot(tool_position(grid.radius_mm, {alpha, std::numbers::pi / 3 * k / kArcPoints})));
        }
        svg += svg_line(axes, arc, "lines");
    }
    return svg;
}

}  // namespace

std::string mechanism_svg(const TwoTierGrid& grid, std::span<const Eigen::Vector2d> polyline, const GridPath& path) {
    const double reach = kMargin * grid.radius_mm;
    const PlotAxes axes{kWidth, kHeight, -reach, reach, -reach, reach, "x, mm", "y, mm"};
    std::vector<PlotPoint> wanted, way;
    std::transform(polyline.begin(), polyline.end(), std::back_inserter(wanted), plot);
    for (const PathNode& node : path.nodes) {
        way.push_back(plot(position(grid, node.node)));
    }
    std::string svg = svg_axes(axes, "Interpolation grid of the two-tier mechanism with the path over it") +
                      grid_lines(axes, grid) + svg_line(axes, wanted, "wanted") + svg_line(axes, way, "way");
    if (way.size() <= kMostDots) {
        svg += svg_dots(axes, way, 3, "node");
    }
    return svg_file(svg + svg_end(), kStyle);
}

}  // namespace seampath
