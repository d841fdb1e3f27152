#include <cmath>

#include "stages/angle.hpp"
#include "stages/mechanism/mechanism.hpp"
#include "stages/text.hpp"
#include "tests/papers/sections.hpp"

namespace seampath {
namespace {

using Eigen::Vector2d;
using Rows = std::vector<std::vector<std::string>>;

constexpr double kDiscRadius = 500;

const std::vector<Vector2d>& paper_line() {
    static const std::vector<Vector2d> line{{-350, -100}, {160, 280}};
    return line;
}

GridPath on_grid(double alpha_deg, const std::vector<Vector2d>& line, GridMethod method) {
    return follow(two_tier_grid(kDiscRadius, alpha_deg * kDegree, alpha_deg / 2 * kDegree), line, method);
}

/// Where the inverse kinematics as printed, eq. (1), would put the tool.
Vector2d printed_inverse(const Vector2d& p) {
    const double beta = std::acos((-p.squaredNorm() + 2 * kDiscRadius * kDiscRadius) / (2 * kDiscRadius * kDiscRadius));
    const double alpha =
        std::asin((p.x() * std::cos(beta) - p.x() - std::sin(beta) * p.y()) / (2 * kDiscRadius * (std::cos(beta) + 1)));
    return tool_position(kDiscRadius, {alpha, beta});
}

std::string kinematics() {
    Rows rows{{"point, mm", "tool off by, with (1) as printed", "with its right form"}};
    for (const Vector2d& p : paper_line()) {
        const double here = (tool_position(kDiscRadius, two_tier_angles(kDiscRadius, p)) - p).norm();
        rows.push_back({"(" + shortest(p.x()) + ", " + shortest(p.y()) + ")",
                        fixed((printed_inverse(p) - p).norm(), 1) + " mm",
                        (here < 1e-11 ? "below 1e-11" : fixed(here, 12)) + " mm"});
    }
    return "The inverse kinematics (1) has a wrong sign in its denominator and knows no quadrants. Right is β = 2 "
           "asin(|p| "
           "/ 2R), α = atan2(−y, x) − β/2, with α free at the centre; (2) is right.\n\n" +
           markdown_table(rows);
}

std::string figures() {
    Rows rows{{"rms distance from the line, mm", "printed", "nodes", "of the nodes in between", "of all but the first",
               "of all", "largest"}};
    struct Row {
        GridMethod method;
        const char* name;
        const char* printed;
    };
    for (const Row& row :
         {Row{GridMethod::least_distance, "least distance", "9.914"},
          Row{GridMethod::optimal, "best of eight neighbours", "–"}, Row{GridMethod::bresenham, "Bresenham", "15.799"},
          Row{GridMethod::optimal_single, "best of four neighbours", "–"}}) {
        const GridPath path = on_grid(10, paper_line(), row.method);
        rows.push_back({row.name, row.printed, std::to_string(path.nodes.size()), fixed(path.interior.rms_mm, 6),
                        fixed(path.after_first.rms_mm, 6), fixed(path.all.rms_mm, 6), fixed(path.all.max_mm, 2)});
    }
    return markdown_table(rows) +
           "Each printed figure comes out, but for another set of nodes. On this grid both rules already find the best "
           "way "
           "there is (dynamic programming).\n\n";
}

std::string halving() {
    Rows rows{{"steps, °", "least distance", "best of eight", "Bresenham", "best of four"}};
    for (double alpha_deg = 10; alpha_deg > 0.015; alpha_deg /= 2) {
        rows.push_back({shortest(alpha_deg) + ", " + shortest(alpha_deg / 2)});
        for (const GridMethod method :
             {GridMethod::least_distance, GridMethod::optimal, GridMethod::bresenham, GridMethod::optimal_single}) {
            const GridPath path = on_grid(alpha_deg, paper_line(), method);
            rows.back().push_back(fixed(path.interior.rms_mm, 4) + " (" + std::to_string(path.nodes.size()) + ")");
        }
    }
    return "The same line on finer grids, rms of the nodes in between, mm, and number of nodes. Least distance halves "
           "with "
           "the grid and stays within 2 % of the best; Bresenham's rule stops improving.\n\n" +
           markdown_table(rows);
}

std::string towards_the_centre() {
    const std::vector<Vector2d> line{{330, 20}, {0, 0}};
    Rows rows{{"steps, °", "least distance", "Bresenham"}};
    for (const double alpha_deg : {10.0, 1.0, 0.1, 0.02}) {
        rows.push_back({shortest(alpha_deg) + ", " + shortest(alpha_deg / 2),
                        fixed(on_grid(alpha_deg, line, GridMethod::least_distance).interior.max_mm, 3),
                        fixed(on_grid(alpha_deg, line, GridMethod::bresenham).interior.max_mm, 3)});
    }
    return "What the paper doesn't say: one axis at a time doesn't converge on lines towards the centre. There every "
           "move of "
           "one axis that goes nearer to the end also leaves the line, however fine the grid. From (330, 20) to the "
           "centre, largest distance, mm:\n\n" +
           markdown_table(rows);
}

}  // namespace

std::string mechanism_section() {
    return "## Lines on the grid of a two-tier mechanism\n\n"
           "I. Naumov, A. Paschenko, A. Koltcov, Research and comparative analysis of methods linear interpolation "
           "trajectory of the working tool of a two-tier mechanism, Don State Technical University.\n\n"
           "    build/seampath mechanism two-tier --radius-mm 500 --alpha-step-deg 10 --beta-step-deg 5 --from "
           "-350,-100 "
           "--to 160,280 --table 0.01\n\n" +
           kinematics() + figures() + halving() + towards_the_centre() +
           "A seam that `seampath run` fitted is followed, projected to the mechanism's plane, by\n\n"
           "    build/seampath mechanism two-tier --path out/part --seam 0 --alpha-step-deg 0.02 --beta-step-deg 0.01 "
           "--out out/steps\n";
}

}  // namespace seampath
