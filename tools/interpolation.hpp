#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>

#include "stages/geometry/interpolate.hpp"
#include "stages/geometry/interpolation_check.hpp"

/// What `seampath interpolate` computes, and its forms: text, JSON and plot.
namespace seampath {

/// One method's line and how good it is.
struct MethodResult {
    std::string label;  ///< the method's name; that of `parametric` with its parametrization
    Interpolant line;
    Shape shape;
    std::optional<CheckStatistics> check;  ///< when there are check points
};

struct Comparison {
    std::string x_name, y_name;
    std::vector<double> x, y;
    InterpolateOptions options;
    std::vector<Inflection> inflections;                        ///< of the data
    std::vector<Eigen::Vector2d> checks;                        ///< may be empty
    std::vector<double> at;                                     ///< where values are wanted
    std::vector<MethodResult> results;                          ///< least mean error first, or as asked for
    std::vector<std::pair<std::string, std::string>> left_out;  ///< methods that can't serve the table, and why
    bool differences = false;                                   ///< show the finite differences
};

/// One line for each thing a method's line does that its data don't.
std::vector<std::string> warnings(const MethodResult& result);

std::string comparison_text(const Comparison& comparison);
nlohmann::ordered_json comparison_json(const Comparison& comparison);

/// The CSS class of line i of a plot, the style of so many lines as an SVG element, and their legend.
std::string line_class(std::size_t i);
std::string line_style(std::size_t lines);
std::string line_legend(const std::vector<std::string>& labels, double left_px, double line_px);

/// A plot of all lines with nodes and check points, as a file of its own.
std::string comparison_svg(const Comparison& comparison);

}  // namespace seampath
