#include <cmath>
#include <iostream>
#include <memory>

#include <nlohmann/json.hpp>

#include "pipeline/text.hpp"
#include "stages/error.hpp"
#include "stages/geometry/parametrize.hpp"
#include "stages/text.hpp"
#include "tools/choice.hpp"
#include "tools/commands.hpp"
#include "tools/output.hpp"
#include "tools/table.hpp"

namespace seampath {
namespace {

using Json = nlohmann::ordered_json;
using Rows = std::vector<std::vector<std::string>>;

constexpr std::array<std::string_view, 2> kSolverNames{"lbfgs", "gradient-projection"};

struct ParametrizeArguments {
    std::string points;
    std::string objective = "chord";
    std::string solver = "lbfgs";
    std::vector<double> weights;
    std::vector<double> limits;
    std::string out;
    bool json = false;
};

ParametrizeOptions options_of(const ParametrizeArguments& given) {
    ParametrizeOptions options;
    options.objective = static_cast<Objective>(choice("--objective", given.objective, kObjectiveNames));
    options.solver = static_cast<Solver>(choice("--solver", given.solver, kSolverNames));
    if (options.solver == Solver::gradient_projection && options.objective != Objective::exact &&
        options.objective != Objective::diagonal) {
        throw InputError("--solver: gradient-projection is for the objectives exact and diagonal, not for " +
                         given.objective + "; leave it out");
    }
    options.weights = given.weights;
    options.limits = given.limits;
    return options;
}

std::vector<Eigen::VectorXd> points_of(const Table& table, const std::string& file) {
    std::vector<Eigen::VectorXd> points;
    for (const auto& row : table.rows) {
        points.emplace_back(Eigen::Map<const Eigen::VectorXd>(row.data(), static_cast<Eigen::Index>(row.size())));
    }
    if (const auto i = first_repeated(points)) {
        throw InputError("parametrize: " + file + ": rows " + std::to_string(*i + 1) + " and " +
                         std::to_string(*i + 2) + " (lines " + std::to_string(table.lines[*i]) + " and " +
                         std::to_string(table.lines[*i + 1]) +
                         ") are the same point; a spline needs points that differ from their neighbours; remove one");
    }
    return points;
}

std::string coordinate_name(const Table& table, std::size_t k) {
    return table.header.empty() ? "c" + std::to_string(k + 1) : table.header[k];
}

/// When each point is passed if the travel is as short as the limits allow, s.
std::vector<double> times(const Parametrization& result) {
    std::vector<double> all;
    for (const double t : result.t) {
        all.push_back(t * std::sqrt(result.peak));
    }
    return all;
}

/// Largest acceleration of each coordinate at these times, over its limit.
std::vector<double> over_limits(const Parametrization& result, const std::vector<double>& limits) {
    std::vector<double> shares;
    for (std::size_t k = 0; k < limits.size(); ++k) {
        shares.push_back(result.peak > 0 ? result.max_acceleration[k] / result.peak / limits[k] : 0);
    }
    return shares;
}

/// The points with their parameter before them, and with limits their time.
std::string csv(const Table& table, const Parametrization& result, bool timed) {
    const std::vector<double> time = times(result);
    std::string text = timed ? "t,time_s" : "t";
    for (std::size_t k = 0; k < table.rows[0].size(); ++k) {
        text += "," + coordinate_name(table, k);
    }
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
        text += "\n" + shortest(result.t[i]) + (timed ? "," + shortest(time[i]) : "");
        for (const double value : table.rows[i]) {
            text += "," + shortest(value);
        }
    }
    return text + "\n";
}

double travel_time_saved(const Parametrization& result, const Parametrization& chord) {
    return chord.peak > 0 ? 1 - std::sqrt(result.peak / chord.peak) : 0;
}

Json bending_json(const Parametrization& result) {
    return {{"exact_energy", result.exact_energy},
            {"diagonal_energy", result.diagonal_energy},
            {"max_acceleration", result.max_acceleration},
            {"peak", result.peak},
            {"travel_time", std::sqrt(result.peak)}};
}

Json result_json(const ParametrizeArguments& given, const Parametrization& result, const Parametrization& chord) {
    Json json{{"objective", given.objective}, {"t", result.t}};
    json.update(bending_json(result));
    if (!given.limits.empty()) {
        json["time_s"] = times(result);
        json["acceleration_over_limit"] = over_limits(result, given.limits);
    }
    json["chord"] = bending_json(chord);
    json["travel_time_saved"] = travel_time_saved(result, chord);
    json["evaluations"] = result.evaluations;
    json["iterations"] = result.iterations;
    json["converged"] = result.converged;
    return json;
}

void print(const ParametrizeArguments& given, const Table& table, const Parametrization& result,
           const Parametrization& chord) {
    Rows rows{{"", given.objective, "chord"}};
    const auto add = [&](const std::string& what, double value, double of_chord, int decimals) {
        rows.push_back({what, fixed(value, decimals), fixed(of_chord, decimals)});
    };
    add("bending energy, exact (31)", result.exact_energy, chord.exact_energy, 4);
    add("bending energy, diagonal (34)", result.diagonal_energy, chord.diagonal_energy, 4);
    for (std::size_t k = 0; k < result.max_acceleration.size(); ++k) {
        add("largest acceleration, " + coordinate_name(table, k), result.max_acceleration[k], chord.max_acceleration[k],
            3);
    }
    for (std::size_t k = 0; k < given.limits.size(); ++k) {
        add("over limit in the shortest time, " + coordinate_name(table, k), over_limits(result, given.limits)[k],
            over_limits(chord, given.limits)[k], 4);
    }
    add("largest over its limit", result.peak, chord.peak, 4);
    add("shortest travel time", std::sqrt(result.peak), std::sqrt(chord.peak), 4);
    std::cout << aligned(rows)
              << "travel time saved against chord length: " << fixed(100 * travel_time_saved(result, chord), 1)
              << " %\n";
    if (result.evaluations > 0) {
        std::cout << result.evaluations << " evaluations"
                  << (result.converged ? "\n" : "; the search ended before its minimum\n");
    }
    Rows parameters{{"row", "t"}};
    for (std::size_t i = 0; i < result.t.size(); ++i) {
        parameters.push_back({std::to_string(i + 1), fixed(result.t[i], 6)});
    }
    for (std::size_t i = 0; !given.limits.empty() && i < parameters.size(); ++i) {
        parameters[i].push_back(i == 0 ? "time s" : fixed(times(result)[i - 1], 4));
    }
    std::cout << "\n" << aligned(parameters);
}

int parametrize_points(const ParametrizeArguments& given) {
    ParametrizeOptions options = options_of(given);
    const Table table = read_table(given.points);
    const auto points = points_of(table, given.points);
    const Parametrization result = parametrize(points, options);
    options.objective = Objective::chord;
    const Parametrization chord = parametrize(points, options);
    if (!given.out.empty()) {
        write_output(given.out, csv(table, result, !given.limits.empty()));
    }
    if (given.json) {
        std::cout << result_json(given, result, chord).dump(4) << "\n";
    } else {
        print(given, table, result, chord);
    }
    return kPass;
}

}  // namespace

Command parametrize_command(CLI::App& program) {
    CLI::App* app = program.add_subcommand(
        "parametrize", "parameters for a cubic spline through points, in the plane, in space or in joint angles");
    const auto given = std::make_shared<ParametrizeArguments>();
    app->add_option("POINTS", given->points, "table: a row a point, a column a coordinate")->required();
    app->add_option("--objective", given->objective,
                    "what the spacing follows (chord, centripetal, foley) or makes least: bending energy, exact or "
                    "diagonal (Marin, 31 and 34), or the largest acceleration, minimax; default chord");
    app->add_option("--weights", given->weights, "alpha of each coordinate, with commas between; default 1")
        ->delimiter(',')
        ->allow_extra_args(false);
    app->add_option("--limits", given->limits,
                    "acceleration limit of each coordinate, per s^2, with commas between; default the weights")
        ->delimiter(',')
        ->allow_extra_args(false);
    app->add_option("--solver", given->solver, "lbfgs, or the paper's gradient-projection for comparison");
    app->add_option("--out", given->out,
                    "CSV file to write: each point with its t before it, and its time when there are limits");
    app->add_flag("--json", given->json, "for machines");
    app->footer(
        "Examples:\n"
        "  seampath parametrize curve.csv --objective foley --out curve_t.csv\n"
        "  seampath parametrize tests/papers/marin_table_2.csv --objective exact\n"
        "  seampath parametrize tests/papers/marin_table_4.csv --objective minimax --limits 1,1,2,6,6,6 --out "
        "joints_t.csv\n"
        "t runs from 0 to 1. The shortest travel time is that in which no coordinate exceeds its limit, in s; with "
        "--limits each row gets its "
        "time in it.\n");
    return {app, [given] { return parametrize_points(*given); }};
}

}  // namespace seampath
