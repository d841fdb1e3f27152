#include <cmath>

#include "stages/geometry/differences.hpp"
#include "stages/geometry/interpolation_check.hpp"
#include "stages/geometry/polynomial.hpp"
#include "stages/text.hpp"
#include "tests/papers/sections.hpp"
#include "tests/papers/tables.hpp"

namespace seampath {
namespace {

using Rows = std::vector<std::vector<std::string>>;

std::string polynomial_table() {
    const auto x = paper_column("minejeva_table_2.csv", 0), y = paper_column("minejeva_table_2.csv", 1);
    const auto a = power_coefficients(x, divided_differences(x, y));
    const DifferenceTable table(x, y, 5);
    const double p1 = value(table, place(table, Formula::newton_forward, 1, 5));
    return markdown_table({{"table II", "printed", "computed", "exactly"},
                           {"Δ⁵y₀ (table III)", "2.55", fixed(table(5, 0), 4), "2.55"},
                           {"x⁵ in (18)", "0.000067", fixed(a[5], 10), "17/25600"},
                           {"x⁴", "−0.0203", fixed(a[4], 10), "−13/640"},
                           {"x³", "0.2378", fixed(a[3], 10), "913/3840"},
                           {"x²", "+1.3375", fixed(a[2], 10), "−107/80"},
                           {"x", "1.6742", fixed(a[1], 10), "4591/1200"},
                           {"P₅(1)", "2.706", fixed(p1, 10), "2.7064453125"},
                           {"error at x = 1, mm", "2.44", fixed(10 * (2.95 - p1), 3), "2.435546875"}});
}

/// Which formula the program takes where in a table of 11 rows, the degree being 5 at most.
std::string rules_table() {
    std::vector<double> x;
    for (int i = 0; i <= 10; ++i) {
        x.push_back(i);
    }
    const DifferenceTable table(x, x, 6);
    const std::vector<double> places{0.125, 0.5, 0.875};
    Rows rows{{"rows", "U below 0.25", "0.25 to 0.75", "above 0.75"}};
    for (int i = 0; i < 10; ++i) {
        std::vector<std::string> cells;
        for (const double u : places) {
            const Placement at = choose(table, i + u, 5);
            cells.push_back(std::string(name(at.formula)) + " of degree " + std::to_string(at.degree) + " about row " +
                            std::to_string(at.origin + 1));
        }
        rows.push_back({std::to_string(i + 1) + ", " + std::to_string(i + 2), cells[0], cells[1], cells[2]});
    }
    return markdown_table(rows);
}

struct PaperSeam {
    std::vector<double> x = paper_column("minejeva_table_4.csv", 0);
    std::vector<double> y = paper_column("minejeva_table_4.csv", 1);
    std::vector<Eigen::Vector2d> checks;

    PaperSeam() {
        for (const auto& point : paper_points("minejeva_check_points.csv")) {
            checks.emplace_back(point);
        }
    }
};

std::string statistics_table(const PaperSeam& seam) {
    const CheckStatistics s = check_points(interpolate(Method::natural, seam.x, seam.y, {}), seam.checks);
    const double sample_variance = s.sample_variance.value_or(0);
    return markdown_table(
        {{"natural cubic spline of table IV, 18 check points, cm", "printed", "computed"},
         {"mean of the differences", "0.088", fixed(s.mean, 4)},
         {"dispersion, over N and over N − 1", "3.246e-3", fixed(s.variance, 7) + ", " + fixed(sample_variance, 7)},
         {"mean square deviation, its root", "0.057",
          fixed(std::sqrt(s.variance), 4) + ", " + fixed(std::sqrt(sample_variance), 4)},
         {"rms of the differences", "", fixed(s.rms, 4)},
         {"largest difference", "", fixed(s.max, 4) + " at x = " + fixed(s.max_x, 1)}});
}

std::string ranking_table(const PaperSeam& seam) {
    struct Row {
        std::string label;
        Method method;
        InterpolateOptions options;
    };
    const auto over = [](Objective objective) {
        InterpolateOptions options;
        options.parametrization = objective;
        return options;
    };
    InterpolateOptions whole;
    whole.degree = 11;
    Rows rows{{"table IV by", "mean", "rms", "largest", "mean distance", "largest distance", "turns (data: 0)"}};
    for (const Row& row :
         std::vector<Row>{{"parametric cubic, chord length", Method::parametric, over(Objective::chord)},
                          {"parametric cubic, Marin's (31)", Method::parametric, over(Objective::exact)},
                          {"parametric cubic, Foley", Method::parametric, over(Objective::foley)},
                          {"PCHIP", Method::pchip, {}},
                          {"Akima", Method::akima, {}},
                          {"not-a-knot spline", Method::not_a_knot, {}},
                          {"**natural spline, the paper's choice**", Method::natural, {}},
                          {"straight lines", Method::linear, {}},
                          {"Newton's polynomial of degree 11", Method::newton_divided, whole}}) {
        const Interpolant line = interpolate(row.method, seam.x, seam.y, row.options);
        const CheckStatistics s = check_points(line, seam.checks);
        rows.push_back({row.label, fixed(s.mean, 4), fixed(s.rms, 4), fixed(s.max, 4), fixed(s.distance_mean, 4),
                        fixed(s.distance_max, 4), std::to_string(shape_of(line, seam.x, seam.y).turns)});
    }
    return markdown_table(rows);
}

}  // namespace

std::string interpolation_section() {
    const PaperSeam seam;
    const Shape natural = shape_of(interpolate(Method::natural, seam.x, seam.y, {}), seam.x, seam.y);
    const Reversal& back = natural.reversals.at(0);
    return "## Interpolation of a tabulated seam\n\n"
           "O. Minejeva, Z. Markovics, Choice of Interpolation Method for an Arbitrary Arc Welding Curve, Riga "
           "Technical University.\n\n"
           "    build/seampath interpolate tests/papers/minejeva_table_2.csv --method newton-forward --at 1 "
           "--differences\n\n" +
           polynomial_table() +
           "The differences of table III are right; (18) has the coefficients of x⁵ and x and the sign of x² wrong. "
           "The "
           "printed value at x = 1 belongs to the right ones. The mean error of 0.752 mm can't be checked, for its "
           "points "
           "are not printed.\n\n"
           "    build/seampath interpolate tests/papers/minejeva_table_4.csv --check "
           "tests/papers/minejeva_check_points.csv \\\n"
           "        --parametrization chord,exact,foley --degree 11\n\n" +
           statistics_table(seam) +
           "The printed statistics stand beside another curve, that of figure 18, whose nodes are not printed.\n\n" +
           ranking_table(seam) +
           "Differences are in y, as the paper takes them, and distances from the line, as a torch sees them; both in "
           "cm. "
           "The natural spline runs against these rising data from x = " +
           fixed(back.from_x, 2) + " to " + fixed(back.to_x, 2) + ", with slope " + fixed(back.slope, 4) +
           " at x = " + fixed(back.x, 2) +
           "; a line that is laid through x and y as functions of their distance does not, and is more than twice as "
           "near "
           "to the seam.\n\n"
           "By the rules of section VI `--method classical` takes for each x, here between two rows of a table of "
           "11,\n\n" +
           rules_table() +
           "Departures from the print: the rows of table I are scrambled; (13) ends in (2n+1)! and Δ²ⁿ⁺¹y₋ₙ; (14) is "
           "over (n+1)!; (20) has the factor dᵢ before its cubic term; (30) and (31) are second derivatives. (32) to "
           "(37) are right.\n\n";
}

}  // namespace seampath
