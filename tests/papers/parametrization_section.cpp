#include <algorithm>
#include <cmath>

#include "stages/geometry/bending.hpp"
#include "stages/geometry/parametrize.hpp"
#include "stages/text.hpp"
#include "tests/papers/parametrized.hpp"
#include "tests/papers/sections.hpp"

namespace seampath {
namespace {

using Rows = std::vector<std::vector<std::string>>;

Parametrization least(const Points& points, Objective objective, const std::vector<double>& weights) {
    ParametrizeOptions options;
    options.objective = objective;
    options.weights = weights;
    return parametrize(points, options);
}

/// The splines over parameters as the paper prints them.
struct AtPrint {
    Bending bending;
    Eigen::VectorXd h;

    AtPrint(const Points& points, const std::vector<double>& t, const std::vector<double>& weights)
        : bending(as_matrix(points), weights), h(spacing(t)) {}
};

std::string worst(const std::vector<double>& a, const std::vector<double>& b) {
    double difference = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        difference = std::max(difference, std::abs(a[i] - b[i]));
    }
    return fixed(difference, 5);
}

std::string energy_table() {
    const auto z = paper_column("marin_table_1.csv", 0);
    const Points one = as_points(z), two = paper_points("marin_table_2.csv"), six = paper_points("marin_table_4.csv");
    const std::vector<double> unit{1, 1};
    const auto t3ex = paper_column("marin_table_3.csv", 1), t3ap = paper_column("marin_table_3.csv", 2);
    const auto t6 = paper_column("marin_table_6.csv", 2);
    const Parametrization closed = least(one, Objective::exact, {});
    const Parametrization exact2 = least(two, Objective::exact, {}), diagonal2 = least(two, Objective::diagonal, {});
    const Parametrization exact6 = least(six, Objective::exact, kRobotWeights);
    const Parametrization diagonal6 = least(six, Objective::diagonal, kRobotWeights);
    const AtPrint ex(two, t3ex, unit), ap(two, t3ap, unit), robot(six, t6, kRobotWeights);
    const auto chord = [&](const Points& points, const std::vector<double>& weights) {
        return fixed(least(points, Objective::chord, weights).exact_energy, 4);
    };
    return markdown_table(
        {{"", "over chord length", "at the printed parameters", "computed optimum", "parameters differ by at most"},
         {"table I, (31), closed form", chord(one, {}), "", fixed(closed.exact_energy, 4),
          worst(closed.t, paper_column("marin_table_1.csv", 1))},
         {"table III, (31)", chord(two, {}), fixed(ex.bending.exact(ex.h), 4), fixed(exact2.exact_energy, 6),
          worst(exact2.t, t3ex)},
         {"table III, (34)", fixed(least(two, Objective::chord, {}).diagonal_energy, 4),
          fixed(ap.bending.diagonal(ap.h), 4), fixed(diagonal2.diagonal_energy, 6), worst(diagonal2.t, t3ap)},
         {"table VI, (34)", fixed(least(six, Objective::chord, kRobotWeights).diagonal_energy, 4),
          fixed(robot.bending.diagonal(robot.h), 3), fixed(diagonal6.diagonal_energy, 4), worst(diagonal6.t, t6)},
         {"table VI, (31)", chord(six, kRobotWeights), fixed(robot.bending.exact(robot.h), 2),
          fixed(exact6.exact_energy, 4), ""}});
}

std::string digits(const char* table, std::size_t column, const Parametrization& optimum) {
    const auto printed = paper_column(table, column);
    return std::to_string(within_a_digit(printed, optimum.t)) + " of " + std::to_string(printed.size());
}

std::string chord_parameters(const Points& six) {
    const WorkCentre centre = work_centre();
    return "t^CL of table VI is the chord length of the six angles without their weights (" +
           worst(least(six, Objective::chord, {}).t, paper_column("marin_table_6.csv", 0)) +
           " off at most). t^WC is that of table V from row 4 on (" + fixed(centre.worst, 5) +
           " off at most); from row 2 over 3 to 4 the chords are " + fixed(centre.over_row_3, 3) +
           " long where t^WC has " + fixed(centre.over_row_3_by_t, 3) + ": the position of row 3 is misprinted.";
}

std::string acceleration_table() {
    const Points six = paper_points("marin_table_4.csv");
    Rows rows{{"table VII: largest acceleration of axis", "1", "2", "3", "4", "5", "6"}};
    const std::vector<std::string> names{"chord length", "work centre", "(34)"};
    for (std::size_t column = 0; column < 3; ++column) {
        const AtPrint print(six, paper_column("marin_table_6.csv", column), kRobotWeights);
        const auto largest = print.bending.largest(print.h);
        const auto printed = paper_column("marin_table_7.csv", column);
        rows.push_back({names[column] + ", printed"});
        rows.push_back({names[column] + ", computed"});
        for (std::size_t axis = 0; axis < 6; ++axis) {
            const bool misprint = column == 2 && axis == 3;
            rows[rows.size() - 2].push_back(misprint ? "470" : fixed(printed[axis], 0));
            rows.back().push_back(fixed(largest[axis], 0));
        }
    }
    return markdown_table(rows);
}

std::string travel_table() {
    const Points six = paper_points("marin_table_4.csv");
    const auto peak_at = [&](std::size_t column) {
        const AtPrint print(six, paper_column("marin_table_6.csv", column), kRobotWeights);
        const auto largest = print.bending.largest(print.h);
        double peak = 0;
        for (std::size_t axis = 0; axis < 6; ++axis) {
            peak = std::max(peak, largest[axis] / kRobotWeights[axis]);
        }
        return peak;
    };
    const double paper = peak_at(2);
    Rows rows{{"parameters", "largest acceleration over its limit", "travel time, s", "against the paper's best"}};
    const auto add = [&](const std::string& label, double peak) {
        const double change = 100 * (std::sqrt(peak / paper) - 1);
        rows.push_back(
            {label, fixed(peak, 2), fixed(std::sqrt(peak), 2), (change > 0 ? "+" : "") + fixed(change, 1) + " %"});
    };
    add("chord length, as printed", peak_at(0));
    add("work centre, as printed", peak_at(1));
    add("(34), as printed", paper);
    add("Foley", least(six, Objective::foley, kRobotWeights).peak);
    add("(31), optimum", least(six, Objective::exact, kRobotWeights).peak);
    add("**minimax, optimum**", least(six, Objective::minimax, kRobotWeights).peak);
    return markdown_table(rows);
}

/// Evaluations of the objective and its gradient until it is within a share of its least value.
std::string effort(const Points& points, const std::vector<double>& weights, Objective objective, Solver solver,
                   double share) {
    const auto energy = [&](const Parametrization& p) {
        return objective == Objective::exact ? p.exact_energy : p.diagonal_energy;
    };
    const double best = energy(least(points, objective, weights));
    ParametrizeOptions options{objective, solver, weights, {}, 1e-15, 1};
    while (options.max_evaluations < 500 && energy(parametrize(points, options)) > best * (1 + share)) {
        ++options.max_evaluations;
    }
    return std::to_string(options.max_evaluations - (solver == Solver::gradient_projection ? 1 : 0));
}

std::string effort_table() {
    const Points two = paper_points("marin_table_2.csv"), six = paper_points("marin_table_4.csv");
    Rows rows{{"effort to come within", "1e-3", "1e-6", "1e-8", "1e-9"}};
    const auto add = [&](const std::string& label, const Points& points, const std::vector<double>& weights,
                         Objective objective, Solver solver) {
        rows.push_back({label});
        for (const double share : {1e-3, 1e-6, 1e-8, 1e-9}) {
            rows.back().push_back(effort(points, weights, objective, solver, share));
        }
    };
    using enum Solver;
    add("table II, (31): iterations of the gradient projection", two, {}, Objective::exact, gradient_projection);
    add("table II, (31): evaluations of L-BFGS", two, {}, Objective::exact, lbfgs);
    add("table IV, (34): iterations of the gradient projection", six, kRobotWeights, Objective::diagonal,
        gradient_projection);
    add("table IV, (31): evaluations of L-BFGS", six, kRobotWeights, Objective::exact, lbfgs);
    add("table IV, (34): evaluations of L-BFGS", six, kRobotWeights, Objective::diagonal, lbfgs);
    return markdown_table(rows);
}

}  // namespace

std::string parametrization_section() {
    const auto z = paper_column("marin_table_1.csv", 0);
    const Points two = paper_points("marin_table_2.csv"), six = paper_points("marin_table_4.csv");
    const double exact = least(six, Objective::exact, kRobotWeights).exact_energy;
    return "## Parametrization of points\n\n"
           "S. P. Marin, An Approach to Data Parametrization in Parametric Cubic Spline Interpolation Problems, "
           "Journal "
           "of Approximation Theory 41 (1984).\n\n"
           "    build/seampath parametrize tests/papers/marin_table_2.csv --objective exact\n"
           "    build/seampath parametrize tests/papers/marin_table_4.csv --objective diagonal --weights "
           "1,1,2,6,6,6\n\n" +
           energy_table() + "All eleven parameters of table I come out to their four digits, with |θ''| = " +
           fixed(least(as_points(z), Objective::exact, {}).max_acceleration[0], 4) +
           " at every turn. In tables III and VI the paper stopped before the optimum: of t^EX " +
           digits("marin_table_3.csv", 1, least(two, Objective::exact, {})) + ", of t^AP of table VI " +
           digits("marin_table_6.csv", 2, least(six, Objective::diagonal, kRobotWeights)) +
           " are within a unit of their last digit. Even at the optimum of (34) the energy (31) itself is " +
           fixed(100 * (least(six, Objective::diagonal, kRobotWeights).exact_energy / exact - 1), 2) +
           " % above its least. " + chord_parameters(six) + "\n\n" + acceleration_table() +
           "Of the eighteen, all come out at the printed parameters but that of axis 4 over (34), a misprint.\n\n"
           "    build/seampath parametrize tests/papers/marin_table_4.csv --objective minimax --limits "
           "1,1,2,6,6,6\n\n" +
           travel_table() +
           "The travel time is the shortest in which no axis exceeds its limit, here 1, 1, 2, 6, 6, 6 rad/s². The "
           "paper "
           "makes the mean acceleration least; making its maximum least is what shortens the travel.\n\n" +
           effort_table();
}

}  // namespace seampath
