#include <algorithm>
#include <iostream>
#include <memory>

#include <nlohmann/json.hpp>

#include "pipeline/text.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"
#include "tools/choice.hpp"
#include "tools/commands.hpp"
#include "tools/interpolation.hpp"
#include "tools/interpolation_run.hpp"
#include "tools/output.hpp"
#include "tools/table.hpp"

namespace seampath {
namespace {

struct InterpolateArguments {
    std::string table;
    std::vector<std::string> methods{"all"};
    std::vector<std::string> parametrizations{"chord"};
    std::string check;
    std::string split;
    int degree = 5;
    std::vector<double> end_slopes;
    std::vector<double> at;
    InterpolateRun run;
    std::string out;
    bool differences = false;
    bool json = false;
};

[[noreturn]] void fail_at(const std::string& file, std::size_t line, const std::string& what) {
    throw InputError("interpolate: " + file + ":" + std::to_string(line) + ": " + what);
}

Table read_pairs(const std::string& file) {
    Table table = read_table(file);
    if (table.rows[0].size() != 2) {
        fail_at(file, table.lines[0],
                std::to_string(table.rows[0].size()) + " columns; two, x and y, were needed; leave out the others");
    }
    return table;
}

void take_table(const std::string& file, Comparison& comparison) {
    const Table table = read_pairs(file);
    for (const auto& row : table.rows) {
        comparison.x.push_back(row[0]);
        comparison.y.push_back(row[1]);
    }
    if (table.rows.size() < 2) {
        fail_at(file, table.lines[0], "the only row of numbers; at least 2 were needed; add rows");
    }
    if (const auto i = first_not_ascending(comparison.x)) {
        fail_at(file, table.lines[*i + 1],
                "x = " + shortest(comparison.x[*i + 1]) + " after x = " + shortest(comparison.x[*i]) + " in line " +
                    std::to_string(table.lines[*i]) +
                    "; x must ascend from row to row; sort the table and remove repeated rows");
    }
    comparison.x_name = table.header.empty() ? "x" : table.header[0];
    comparison.y_name = table.header.empty() ? "y" : table.header[1];
    comparison.inflections = inflections(comparison.x, comparison.y);
}

bool inside(const Comparison& comparison, double x) {
    return x >= comparison.x.front() && x <= comparison.x.back();
}

std::string range(const Comparison& comparison) {
    return " lies outside the table, which goes from " + shortest(comparison.x.front()) + " to " +
           shortest(comparison.x.back()) + "; remove it or extend the table";
}

void take_checks(const std::string& file, Comparison& comparison) {
    const Table table = read_pairs(file);
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
        const Eigen::Vector2d point(table.rows[i][0], table.rows[i][1]);
        if (!inside(comparison, point.x())) {
            fail_at(file, table.lines[i], "x = " + shortest(point.x()) + range(comparison));
        }
        comparison.checks.push_back(point);
    }
}

InterpolateOptions options_of(const InterpolateArguments& given) {
    InterpolateOptions options;
    if (given.degree < 1 || given.degree > static_cast<int>(kMaxDegree)) {
        throw InputError("--degree: " + std::to_string(given.degree) + " is not between 1 and " +
                         std::to_string(kMaxDegree));
    }
    options.degree = static_cast<std::size_t>(given.degree);
    if (!given.split.empty() && given.split != "inflections") {
        throw InputError("--split: \"" + given.split + "\" is unknown; only inflections is there");
    }
    options.split_at_inflections = !given.split.empty();
    if (!given.end_slopes.empty()) {
        if (given.end_slopes.size() != 2) {
            throw InputError("--end-slopes: " + std::to_string(given.end_slopes.size()) +
                             " numbers; two were needed, the slopes at the first and the last row");
        }
        options.end_slopes = {given.end_slopes[0], given.end_slopes[1]};
    }
    return options;
}

void add(Method method, const InterpolateArguments& given, Comparison& comparison) {
    const bool parametric = method == Method::parametric;
    for (const auto& parametrization : parametric ? given.parametrizations : std::vector<std::string>{""}) {
        InterpolateOptions options = comparison.options;
        MethodResult result{std::string(name(method)), {}, {}, {}};
        if (parametric) {
            options.parametrization =
                static_cast<Objective>(choice("--parametrization", parametrization, kObjectiveNames));
            result.label += " (" + parametrization + ")";
        }
        result.line = interpolate(method, comparison.x, comparison.y, options);
        result.shape = shape_of(result.line, comparison.x, comparison.y);
        if (!comparison.checks.empty()) {
            result.check = check_points(result.line, comparison.checks);
        }
        comparison.results.push_back(std::move(result));
    }
}

/// With "all", methods that can't serve this table are left out, with the reason; there must be one that can.
void add_all(const InterpolateArguments& given, Comparison& comparison) {
    for (std::size_t m = 0; m < kMethodNames.size(); ++m) {
        const auto method = static_cast<Method>(m);
        try {
            add(method, given, comparison);
        } catch (const InputError& error) {
            comparison.left_out.emplace_back(name(method), error.what());
        }
    }
    if (comparison.results.empty()) {
        throw InputError(comparison.left_out.back().second);  // what even straight lines can't be laid through
    }
}

double mean_error(const MethodResult& result) {
    return result.check ? result.check->mean : 0;  // without check points the order stays
}

Comparison compare(const InterpolateArguments& given) {
    Comparison comparison;
    comparison.options = options_of(given);
    comparison.differences = given.differences;
    take_table(given.table, comparison);
    if (!given.check.empty()) {
        take_checks(given.check, comparison);
    }
    for (const double x : given.at) {
        if (!inside(comparison, x)) {
            throw InputError("--at: " + shortest(x) + range(comparison));
        }
    }
    comparison.at = given.at;
    if (given.methods == std::vector<std::string>{"all"}) {
        for (const auto& parametrization : given.parametrizations) {
            choice("--parametrization", parametrization, kObjectiveNames);
        }
        add_all(given, comparison);
    } else {
        for (const auto& method : given.methods) {
            add(static_cast<Method>(choice("--method", method, kMethodNames)), given, comparison);
        }
    }
    std::stable_sort(comparison.results.begin(), comparison.results.end(),
                     [](const auto& a, const auto& b) { return mean_error(a) < mean_error(b); });
    return comparison;
}

int interpolate_table(const InterpolateArguments& given) {
    const Comparison comparison = compare(given);
    if (!given.out.empty()) {
        write_output(given.out, comparison_svg(comparison));
    }
    if (given.json) {
        std::cout << comparison_json(comparison).dump(4) << "\n";
    } else {
        std::cout << comparison_text(comparison);
    }
    return kPass;
}

/// Options that one of the two uses has nothing to do with.
void check_use(const CLI::App& app, bool folder) {
    const std::vector<std::string> tables{"--method",     "--check",           "--split", "--degree",
                                          "--end-slopes", "--parametrization", "--at",    "--differences"},
        runs{"--nodes", "--scan"};
    for (const auto& option : folder ? tables : runs) {
        if (app.count(option) > 0) {
            throw InputError(
                option + ": is for " +
                (folder ? "a table, not for the folder of a run" : "the folder of a run, not for a table") +
                "; leave it out");
        }
    }
}

void add_list(CLI::App* app, const std::string& name, auto& values, const std::string& what) {
    app->add_option(name, values, what)->delimiter(',')->allow_extra_args(false);
}

}  // namespace

Command interpolate_command(CLI::App& program) {
    CLI::App* app = program.add_subcommand(
        "interpolate", "classical and spline interpolation of a table or of a scan's seams, compared");
    const auto given = std::make_shared<InterpolateArguments>();
    app->add_option("TABLE", given->table, "table of x and y, x ascending; or the folder of a run")->required();
    add_list(app, "--method", given->methods, "all (default), or with commas between: " + join(kMethodNames));
    app->add_option("--check", given->check, "table of points between the rows that the lines are measured against");
    app->add_option("--split", given->split, "inflections: polynomials end at the data's inflection points");
    app->add_option("--degree", given->degree, "highest degree of the polynomials, 1 to 40; default 5");
    add_list(app, "--end-slopes", given->end_slopes, "of clamped, two numbers; default from three rows at each end");
    add_list(app, "--parametrization", given->parametrizations,
             "of parametric: chord (default), or with commas between: " + join(kObjectiveNames));
    add_list(app, "--at", given->at, "x, with commas between, to print the values at");
    app->add_flag("--differences", given->differences, "print the table of finite differences");
    add_list(app, "--nodes", given->run.nodes, "of a run: numbers of nodes to try, ascending; default 8,16,32");
    app->add_option("--scan", given->run.scan, "of a run: where its scan is now, when it was moved");
    app->add_option("--out", given->out, "SVG file to write: a plot of all lines, or of all rms over the nodes");
    app->add_flag("--json", given->json, "for machines");
    app->footer(
        "Examples:\n"
        "  seampath interpolate tests/papers/minejeva_table_4.csv --check tests/papers/minejeva_check_points.csv\n"
        "  seampath interpolate tests/papers/minejeva_table_2.csv --method newton-forward --at 1 --differences\n"
        "  seampath interpolate out --nodes 6,12,24 --out methods.svg     after seampath run part.ply --out out\n"
        "With --check, methods are ranked by the mean of |e|, the differences in y; distances are those from the line. "
        "On a run's seams they are ranked by the geometric mean of their rms distances; --set fit.model takes one.\n"
        "Exit status: 0, or for a run 1 when it has no seam or on one of them even the line of least rms is out of "
        "tolerance; 2 bad input\n");
    return {app, [given, app] {
                const bool folder = std::filesystem::is_directory(given->table);
                check_use(*app, folder);
                given->run.folder = given->table;
                given->run.out = given->out;
                given->run.json = given->json;
                return folder ? interpolate_run(given->run) : interpolate_table(*given);
            }};
}

}  // namespace seampath
