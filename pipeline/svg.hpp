#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Plots as inline SVG, put together from strings: first svg_axes(), then what is drawn in them, then svg_end().
/// Colours and line widths come from the page's style sheet through `style`, a CSS class.
namespace seampath {

/// A point in the units of the axes. A y that is not finite ends a line; the next finite one begins another.
struct PlotPoint {
    double x = 0;
    double y = 0;
};

/// Size in CSS pixels, ranges (high above low) and labels; a label says quantity and unit.
struct PlotAxes {
    double width = 0;
    double height = 0;
    double x_low = 0;
    double x_high = 1;
    double y_low = 0;
    double y_high = 1;
    std::string x_label;
    std::string y_label;
};

/// Multiples of 1, 2 or 5 times a power of ten within [low, high], about `count` of them.
std::vector<double> nice_ticks(double low, double high, int count);

/// Opens the SVG and draws frame, grid, ticks and labels. `title` is for readers who can't see the plot; data-plot says
/// where the axes are, for scripts: left, right, x_low, x_high, top, bottom.
std::string svg_axes(const PlotAxes& axes, std::string_view title);
std::string svg_end();

/// A finished SVG as a file of its own, with its style in it instead of the page's.
std::string svg_file(std::string_view svg, std::string_view css);

/// A line through the points. Lines of very many points are thinned so that every extreme stays.
std::string svg_line(const PlotAxes& axes, std::span<const PlotPoint> points, std::string_view style);

/// The area between two lines with the same abscissae; broken where either is not finite.
std::string svg_band(const PlotAxes& axes, std::span<const PlotPoint> low, std::span<const PlotPoint> high,
                     std::string_view style);

/// A rectangle in the units of the axes, cut to them.
std::string svg_box(const PlotAxes& axes, PlotPoint low, PlotPoint high, std::string_view style);

/// A dot at each point.
std::string svg_dots(const PlotAxes& axes, std::span<const PlotPoint> points, double radius_px, std::string_view style);

/// A ringed number at each point: 1, 2, ...
std::string svg_numbers(const PlotAxes& axes, std::span<const PlotPoint> points, std::string_view style);

/// A line across the whole plot at y, or at x, with a short text at its end; `line` is the line of text it stands in,
/// so that the texts of neighbouring marks don't cover each other.
std::string svg_level(const PlotAxes& axes, double y, std::string_view text, std::string_view style);
std::string svg_mark(const PlotAxes& axes, double x, std::string_view text, std::string_view style, int line);

}  // namespace seampath
