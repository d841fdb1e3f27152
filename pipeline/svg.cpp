#include "pipeline/svg.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/report_text.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

// Room for tick labels and axis labels around the plot, CSS pixels.
constexpr double kLeft = 66, kRight = 14, kTop = 10, kBottom = 40;

// A line keeps at most two points (lowest and highest) for each of so many columns.
constexpr std::size_t kMostColumns = 700;

double pixel_x(const PlotAxes& axes, double x) {
    return kLeft + (x - axes.x_low) / (axes.x_high - axes.x_low) * (axes.width - kLeft - kRight);
}

double pixel_y(const PlotAxes& axes, double y) {
    const double inside = std::clamp(y, axes.y_low, axes.y_high);
    return axes.height - kBottom - (inside - axes.y_low) / (axes.y_high - axes.y_low) * (axes.height - kTop - kBottom);
}

std::string px(double value) {
    return decimal(value, 1);
}

std::string at(const PlotAxes& axes, PlotPoint p) {
    return px(pixel_x(axes, p.x)) + ' ' + px(pixel_y(axes, p.y));
}

std::string attribute(std::string_view name, std::string_view value) {
    return ' ' + std::string(name) + "=\"" + std::string(value) + '"';
}

std::string line_element(double x1, double y1, double x2, double y2, std::string_view style) {
    return "<line" + attribute("class", style) + attribute("x1", px(x1)) + attribute("y1", px(y1)) +
           attribute("x2", px(x2)) + attribute("y2", px(y2)) + "/>";
}

std::string text_element(double x, double y, std::string_view style, std::string_view text) {
    return "<text" + attribute("class", style) + attribute("x", px(x)) + attribute("y", px(y)) + '>' +
           escape_html(text) + "</text>";
}

/// Decimals that tell neighbouring ticks apart.
int tick_decimals(const std::vector<double>& ticks) {
    if (ticks.size() < 2) {
        return 3;
    }
    return std::clamp(static_cast<int>(std::ceil(-std::log10(ticks[1] - ticks[0]) - 1e-9)), 0, 9);
}

/// Lowest and highest point of each of kMostColumns equal runs, in their order; short lines stay as they are.
std::vector<PlotPoint> thinned(std::span<const PlotPoint> points) {
    if (points.size() <= 2 * kMostColumns) {
        return {points.begin(), points.end()};
    }
    std::vector<PlotPoint> kept;
    for (std::size_t column = 0; column < kMostColumns; ++column) {
        const auto first = points.begin() + static_cast<std::ptrdiff_t>(points.size() * column / kMostColumns);
        const auto last = points.begin() + static_cast<std::ptrdiff_t>(points.size() * (column + 1) / kMostColumns);
        const auto gap = std::find_if(first, last, [](const PlotPoint& p) { return !std::isfinite(p.y); });
        if (gap != last) {
            kept.push_back(*gap);
            continue;
        }
        auto [low, high] = std::minmax_element(first, last, [](const auto& a, const auto& b) { return a.y < b.y; });
        kept.push_back(low < high ? *low : *high);
        kept.push_back(low < high ? *high : *low);
    }
    return kept;
}

}  // namespace

std::vector<double> nice_ticks(double low, double high, int count) {
    ensure(high > low && count > 0, "an axis has a range");
    const double raw = (high - low) / count;
    const double power = std::pow(10, std::floor(std::log10(raw)));
    const double share = raw / power;
    const double step = power * (share < 1.5 ? 1 : share < 3.5 ? 2 : share < 7.5 ? 5 : 10);
    std::vector<double> ticks;
    // The margin keeps a tick that rounding puts just outside.
    for (double k = std::ceil(low / step - 1e-6); k * step <= high + 1e-6 * step; ++k) {
        ticks.push_back(k * step);
    }
    return ticks;
}

std::string svg_axes(const PlotAxes& axes, std::string_view title) {
    const double right = axes.width - kRight, bottom = axes.height - kBottom;
    std::string svg = "<svg" + attribute("class", "plot") + attribute("role", "img") +
                      attribute("viewBox", "0 0 " + px(axes.width) + ' ' + px(axes.height)) +
                      attribute("data-plot", px(kLeft) + ' ' + px(right) + ' ' + shortest(axes.x_low) + ' ' +
                                                 shortest(axes.x_high) + ' ' + px(kTop) + ' ' + px(bottom)) +
                      "><title>" + escape_html(title) + "</title>";
    const auto x_ticks = nice_ticks(axes.x_low, axes.x_high, std::max(2, static_cast<int>(axes.width / 90)));
    const auto y_ticks = nice_ticks(axes.y_low, axes.y_high, std::max(2, static_cast<int>(axes.height / 45)));
    for (const double x : x_ticks) {
        svg += line_element(pixel_x(axes, x), kTop, pixel_x(axes, x), bottom, "grid");
        svg += text_element(pixel_x(axes, x), bottom + 15, "tick middle", decimal(x, tick_decimals(x_ticks)));
    }
    for (const double y : y_ticks) {
        svg += line_element(kLeft, pixel_y(axes, y), right, pixel_y(axes, y), "grid");
        svg += text_element(kLeft - 6, pixel_y(axes, y) + 3.5, "tick end", decimal(y, tick_decimals(y_ticks)));
    }
    svg += line_element(kLeft, bottom, right, bottom, "axis") + line_element(kLeft, kTop, kLeft, bottom, "axis");
    svg += text_element((kLeft + right) / 2, axes.height - 6, "label middle", axes.x_label);
    svg += "<text class=\"label middle\" transform=\"translate(11 " + px((kTop + bottom) / 2) + ") rotate(-90)\">" +
           escape_html(axes.y_label) + "</text>";
    return svg;
}

std::string svg_end() {
    return "</svg>\n";
}

std::string svg_file(std::string_view svg, std::string_view css) {
    constexpr std::string_view kOpening = "<svg";
    ensure(svg.starts_with(kOpening), "an SVG begins with its element");
    const std::size_t inside = svg.find('>') + 1;
    return "<svg xmlns=\"http://www.w3.org/2000/svg\"" +
           std::string(svg.substr(kOpening.size(), inside - kOpening.size())) + "<style>" + std::string(css) +
           "</style>" + std::string(svg.substr(inside));
}

std::string svg_line(const PlotAxes& axes, std::span<const PlotPoint> points, std::string_view style) {
    std::string path;
    bool pen_down = false;
    for (const PlotPoint& p : thinned(points)) {
        if (std::isfinite(p.y)) {
            path += (pen_down ? 'L' : 'M') + at(axes, p);
        }
        pen_down = std::isfinite(p.y);
    }
    return "<path" + attribute("class", style) + attribute("d", path) + "/>";
}

std::string svg_band(const PlotAxes& axes, std::span<const PlotPoint> low, std::span<const PlotPoint> high,
                     std::string_view style) {
    ensure(low.size() == high.size(), "both edges of a band have the same abscissae");
    const auto finite = [&](std::size_t i) { return std::isfinite(low[i].y) && std::isfinite(high[i].y); };
    std::string path;
    for (std::size_t first = 0; first < low.size(); ++first) {
        std::size_t last = first;
        while (last < low.size() && finite(last)) {
            ++last;
        }
        if (last - first < 2) {
            continue;
        }
        auto edge = thinned(low.subspan(first, last - first));
        const auto upper = thinned(high.subspan(first, last - first));
        edge.insert(edge.end(), upper.rbegin(), upper.rend());
        for (std::size_t i = 0; i < edge.size(); ++i) {
            path += (i == 0 ? 'M' : 'L') + at(axes, edge[i]);
        }
        path += 'Z';
        first = last;
    }
    return "<path" + attribute("class", style) + attribute("d", path) + "/>";
}

std::string svg_box(const PlotAxes& axes, PlotPoint low, PlotPoint high, std::string_view style) {
    const double x1 = pixel_x(axes, std::max(low.x, axes.x_low)), x2 = pixel_x(axes, std::min(high.x, axes.x_high));
    const double y1 = pixel_y(axes, high.y), y2 = pixel_y(axes, low.y);
    return "<rect" + attribute("class", style) + attribute("x", px(x1)) + attribute("y", px(y1)) +
           attribute("width", px(std::max(0.0, x2 - x1))) + attribute("height", px(std::max(0.0, y2 - y1))) + "/>";
}

std::string svg_dots(const PlotAxes& axes, std::span<const PlotPoint> points, double radius_px,
                     std::string_view style) {
    std::string svg = "<g" + attribute("class", style) + '>';
    for (const PlotPoint& p : points) {
        svg += "<circle" + attribute("cx", px(pixel_x(axes, p.x))) + attribute("cy", px(pixel_y(axes, p.y))) +
               attribute("r", px(radius_px)) + "/>";
    }
    return svg + "</g>";
}

std::string svg_numbers(const PlotAxes& axes, std::span<const PlotPoint> points, std::string_view style) {
    constexpr double kRing = 7.5, kAbove = 11;  // CSS pixels
    std::string svg = "<g" + attribute("class", style) + '>';
    for (std::size_t k = 0; k < points.size(); ++k) {
        const double x = pixel_x(axes, points[k].x);
        const double y = std::max(kTop + kRing, pixel_y(axes, points[k].y) - kAbove);
        svg += "<circle" + attribute("cx", px(x)) + attribute("cy", px(y)) + attribute("r", px(kRing)) + "/>" +
               text_element(x, y + 3.8, "middle", std::to_string(k + 1));
    }
    return svg + "</g>";
}

std::string svg_level(const PlotAxes& axes, double y, std::string_view text, std::string_view style) {
    return line_element(kLeft, pixel_y(axes, y), axes.width - kRight, pixel_y(axes, y), style) +
           text_element(axes.width - kRight - 4, pixel_y(axes, y) - 4, "note end", text);
}

std::string svg_mark(const PlotAxes& axes, double x, std::string_view text, std::string_view style, int line) {
    const bool left = pixel_x(axes, x) > 0.7 * axes.width;
    return line_element(pixel_x(axes, x), kTop, pixel_x(axes, x), axes.height - kBottom, style) +
           text_element(pixel_x(axes, x) + (left ? -4 : 4), kTop + 11 + 14 * line, left ? "note end" : "note", text);
}

}  // namespace seampath
