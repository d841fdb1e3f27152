#include <charconv>
#include <cmath>

#include <nlohmann/json.hpp>

#include "pipeline/text.hpp"
#include "stages/error.hpp"
#include "stages/geometry/polynomial.hpp"
#include "stages/text.hpp"
#include "tools/interpolation.hpp"

namespace seampath {
namespace {

using Json = nlohmann::ordered_json;
using Cells = std::vector<std::string>;
using Rows = std::vector<Cells>;

std::string digits(double value, int count) {
    char buffer[40];
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, value, std::chars_format::general, count).ptr;
    return {buffer, end};
}

std::string digits(const std::optional<double>& value, int count) {
    return value ? digits(*value, count) : "-";
}

std::string plural(int count, const std::string& word) {
    return std::to_string(count) + " " + word + (count == 1 ? "" : "s");
}

/// The finite differences of the whole table, or nothing when its steps are not equal.
std::optional<DifferenceTable> differences_of(const Comparison& comparison) {
    try {
        return DifferenceTable(comparison.x, comparison.y, comparison.options.degree);
    } catch (const InputError&) {
        return std::nullopt;
    }
}

/// Coefficients of the polynomial through all rows, where the degree and the split allow one.
std::vector<double> whole_polynomial(const Comparison& comparison) {
    const bool split = comparison.options.split_at_inflections && !comparison.inflections.empty();
    if (split || comparison.x.size() > comparison.options.degree + 1) {
        return {};
    }
    return power_coefficients(comparison.x, divided_differences(comparison.x, comparison.y));
}

std::string ranking(const Comparison& comparison) {
    Rows rows{{"", "method", "mean |e|", "variance/N", "/(N-1)", "root/N", "/(N-1)", "rms", "max", "at x",
               "distance mean", "rms", "max", "warnings"}};
    for (const MethodResult& result : comparison.results) {
        const CheckStatistics& s = *result.check;
        rows.push_back({std::to_string(rows.size()), result.label, fixed(s.mean, 4), digits(s.variance, 5),
                        digits(s.sample_variance, 5), fixed(std::sqrt(s.variance), 4),
                        s.sample_variance ? fixed(std::sqrt(*s.sample_variance), 4) : "-", fixed(s.rms, 4),
                        fixed(s.max, 4), shortest(s.max_x), fixed(s.distance_mean, 4), fixed(s.distance_rms, 4),
                        fixed(s.distance_max, 4), std::to_string(warnings(result).size())});
    }
    return aligned(rows);
}

std::string shapes(const Comparison& comparison) {
    Rows rows{{"method", "turns", "of the data", "reversals", "overshoot", "jump", "warnings"}};
    for (const MethodResult& result : comparison.results) {
        const Shape& shape = result.shape;
        rows.push_back({result.label, std::to_string(shape.turns), std::to_string(shape.data_turns),
                        std::to_string(shape.reversals.size()), digits(shape.overshoot, 4), digits(shape.jump, 4),
                        std::to_string(warnings(result).size())});
    }
    return aligned(rows) + "--check POINTS.csv measures and ranks them\n";
}

std::string difference_text(const Comparison& comparison) {
    const auto table = differences_of(comparison);
    if (!table) {
        return "no finite differences: the steps are not equal\n";
    }
    Rows rows{{comparison.x_name, comparison.y_name}};
    for (std::size_t order = 1; order <= table->max_order(); ++order) {
        rows[0].push_back("D" + std::to_string(order));
    }
    for (std::size_t i = 0; i < table->nodes(); ++i) {
        Cells cells{shortest(comparison.x[i])};
        for (std::size_t order = 0; order <= table->max_order(); ++order) {
            cells.push_back(i + order < table->nodes() ? digits((*table)(order, i), 10) : "");
        }
        rows.push_back(std::move(cells));
    }
    return aligned(rows);
}

double step(const Comparison& comparison) {
    return (comparison.x.back() - comparison.x.front()) / static_cast<double>(comparison.x.size() - 1);
}

std::string value_text(const Comparison& comparison) {
    Rows rows{{"x", "method", comparison.y_name, "formula", "x0", "U", "degree", "estimated error"}};
    for (const double x : comparison.at) {
        for (const MethodResult& result : comparison.results) {
            const Evaluation e = result.line.evaluate(x);
            Cells cells{shortest(x), result.label, digits(e.y, 10), "", "", "", "", digits(e.estimated_error, 3)};
            if (const auto& p = e.placement) {
                cells[3] = name(p->formula);
                cells[4] = digits(x - p->u * step(comparison), 10);
                cells[5] = digits(p->u, 6);
                cells[6] = std::to_string(p->degree);
            }
            rows.push_back(std::move(cells));
        }
    }
    return aligned(rows);
}

std::string notes(const Comparison& comparison) {
    std::string text;
    for (const MethodResult& result : comparison.results) {
        for (const auto& warning : warnings(result)) {
            text += "warning: " + result.label + ": " + warning + "\n";
        }
    }
    for (std::size_t i = 0; i < comparison.left_out.size(); ++i) {
        const auto& [method, reason] = comparison.left_out[i];
        const bool first = i == 0 || comparison.left_out[i - 1].second != reason;
        const bool last = i + 1 == comparison.left_out.size() || comparison.left_out[i + 1].second != reason;
        text += (first ? "left out: " : ", ") + method + (last ? ": " + reason + "\n" : "");
    }
    return text;
}

Json statistics_json(const CheckStatistics& s) {
    return {{"mean", s.mean},
            {"variance_n", s.variance},
            {"variance_n_1", s.sample_variance ? Json(*s.sample_variance) : Json()},
            {"root_variance_n", std::sqrt(s.variance)},
            {"root_variance_n_1", s.sample_variance ? Json(std::sqrt(*s.sample_variance)) : Json()},
            {"rms", s.rms},
            {"max", s.max},
            {"max_x", s.max_x},
            {"distance_mean", s.distance_mean},
            {"distance_rms", s.distance_rms},
            {"distance_max", s.distance_max},
            {"error", s.error},
            {"distance", s.distance}};
}

Json shape_json(const Shape& shape) {
    Json reversals = Json::array();
    for (const Reversal& r : shape.reversals) {
        reversals.push_back({{"from_x", r.from_x}, {"to_x", r.to_x}, {"x", r.x}, {"slope", r.slope}});
    }
    return {{"turns", shape.turns},         {"data_turns", shape.data_turns},   {"reversals", reversals},
            {"overshoot", shape.overshoot}, {"overshoot_x", shape.overshoot_x}, {"jump", shape.jump},
            {"jump_x", shape.jump_x},       {"runs_back", shape.runs_back}};
}

Json value_json(const Comparison& comparison, const MethodResult& result, double x) {
    const Evaluation e = result.line.evaluate(x);
    Json value{{"x", x}, {"y", e.y}};
    if (const auto& p = e.placement) {
        value["formula"] = name(p->formula);
        value["x0"] = x - p->u * step(comparison);
        value["u"] = p->u;
        value["degree"] = p->degree;
        value["estimated_error"] = e.estimated_error ? Json(*e.estimated_error) : Json();
    }
    return value;
}

Json method_json(const Comparison& comparison, const MethodResult& result) {
    Json json{{"method", result.label}};
    if (result.check) {
        json["check"] = statistics_json(*result.check);
    }
    json["shape"] = shape_json(result.shape);
    json["warnings"] = warnings(result);
    if (!comparison.at.empty()) {
        json["values"] = Json::array();
        for (const double x : comparison.at) {
            json["values"].push_back(value_json(comparison, result, x));
        }
    }
    return json;
}

Json difference_json(const Comparison& comparison) {
    const auto table = differences_of(comparison);
    Json json;
    for (std::size_t order = 1; table && order <= table->max_order(); ++order) {
        Json column = Json::array();
        for (std::size_t i = 0; i + order < table->nodes(); ++i) {
            column.push_back((*table)(order, i));
        }
        json.push_back(std::move(column));
    }
    return json;  // null for unequal steps
}

}  // namespace

std::vector<std::string> warnings(const MethodResult& result) {
    std::vector<std::string> all;
    const Shape& shape = result.shape;
    for (const Reversal& r : shape.reversals) {
        all.push_back("runs against the data from x = " + digits(r.from_x, 4) + " to " + digits(r.to_x, 4) +
                      ", with slope " + digits(r.slope, 3) + " at x = " + digits(r.x, 4));
    }
    if (shape.turns > shape.data_turns) {
        all.push_back("oscillates: " + plural(shape.turns, "turn") + " where the data have " +
                      std::to_string(shape.data_turns));
    }
    if (shape.overshoot > 0) {
        all.push_back("leaves the range of its two nodes by " + digits(shape.overshoot, 3) +
                      " at x = " + digits(shape.overshoot_x, 4));
    }
    if (shape.jump > 0) {
        all.push_back("is not continuous: it jumps by " + digits(shape.jump, 3) + " at x = " + digits(shape.jump_x, 4));
    }
    if (shape.runs_back) {
        all.emplace_back("runs back in x: it has several y at one x");
    }
    return all;
}

std::string comparison_text(const Comparison& comparison) {
    std::string text = plural(static_cast<int>(comparison.x.size()), "row") + ", ";
    text += differences_of(comparison) ? "equal steps of " + digits(step(comparison), 10) : "unequal steps";
    text += ", " + plural(static_cast<int>(comparison.inflections.size()), "inflection");
    for (const Inflection& inflection : comparison.inflections) {
        text += (&inflection == comparison.inflections.data() ? " at x = " : ", ") + digits(inflection.x, 4);
    }
    text += comparison.options.split_at_inflections ? "; polynomials are split there\n\n" : "\n\n";
    text += comparison.checks.empty() ? shapes(comparison) : ranking(comparison);
    if (const std::string more = notes(comparison); !more.empty()) {
        text += "\n" + more;
    }
    if (const auto a = whole_polynomial(comparison); !a.empty()) {
        text += "\npolynomial through all rows, coefficients of 1, x, x^2 ...:";
        for (const double coefficient : a) {
            text += " " + digits(coefficient, 10);
        }
        text += "\n";
    }
    text += comparison.differences ? "\n" + difference_text(comparison) : "";
    text += comparison.at.empty() ? "" : "\n" + value_text(comparison);
    return text;
}

Json comparison_json(const Comparison& comparison) {
    Json inflections = Json::array();
    for (const Inflection& inflection : comparison.inflections) {
        inflections.push_back({{"x", inflection.x}, {"node_x", comparison.x[inflection.node]}});
    }
    Json json{{"rows", comparison.x.size()},
              {"degree", comparison.options.degree},
              {"split", comparison.options.split_at_inflections},
              {"inflections", inflections},
              {"methods", Json::array()},
              {"left_out", Json::array()}};
    if (const auto a = whole_polynomial(comparison); !a.empty()) {
        json["polynomial"] = a;
    }
    if (comparison.differences) {
        json["differences"] = difference_json(comparison);
    }
    for (const MethodResult& result : comparison.results) {
        json["methods"].push_back(method_json(comparison, result));
    }
    for (const auto& [method, reason] : comparison.left_out) {
        json["left_out"].push_back({{"method", method}, {"reason", reason}});
    }
    return json;
}

}  // namespace seampath
