#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/nominal/nominal.hpp"
#include "stages/plan/plan.hpp"
#include "stages/text.hpp"
#include "tests/papers/saddles.hpp"
#include "tests/papers/sections.hpp"
#include "tests/papers/tables.hpp"

namespace seampath {
namespace {

using Rows = std::vector<std::vector<std::string>>;

constexpr double kPi = std::numbers::pi;

std::string range_text(double low, double high, int decimals) {
    return fixed(low, decimals) + " to " + fixed(high, decimals);
}

struct Range {
    double low = 1e300, high = -1e300;
    void add(double value) {
        low = std::min(low, value);
        high = std::max(high, value);
    }
};

std::string table_1() {
    const SaddleCurve curve = pipes(600, 150);
    const auto printed = read_table(paper_file("xue_table_1.csv")).rows;
    int values = 0, same = 0;
    Range arc;
    for (std::size_t k = 0; k < printed.size(); ++k) {
        const double theta = kPi * static_cast<double>(k) / 20;
        const SaddlePoint s = curve.at(theta);
        const std::array<double, 5> here{theta, s.p.x(), s.p.y(), s.p.z(), torch_angle(s, PoseLaw::paper, kPi / 4)};
        for (std::size_t column = 0; column < here.size(); ++column) {
            same += fixed(here[column], 4) == fixed(printed[k][column], 4) ? 1 : 0;
            ++values;
        }
        if (k > 0) {
            arc.add(curve.station(theta) - curve.station(theta - kPi / 20));
        }
    }
    return "Of table 1, " + std::to_string(same) + " of " + std::to_string(values) +
           " values come out to every printed digit, with equal branch angles and δ in rad (printed: mm). So the table "
           "shows equal-angle steps, arcs of " +
           range_text(arc.low, arc.high, 3) + " mm, not the variable-angle interpolation that the paper is about.\n\n";
}

std::string speeds() {
    Rows rows{{"r / R, mm", "step, mm", "by (24): speed error of the straight moves",
               "by the arc's inversion: error, mm", "speed error of the straight moves"}};
    struct Case {
        double R, r, step;
    };
    for (const Case& c : {Case{600, 150, 1}, Case{600, 150, 5}, Case{600, 540, 5}, Case{150, 149.9, 5}}) {
        const SaddleCurve curve = pipes(c.R, c.r);
        const auto errors = [&](StepLaw law) { return step_errors(curve, step_angles(curve, law, c.step), c.step); };
        const StepErrors inverted = errors(StepLaw::arc_length);
        const double left = inverted.arc * c.step;
        rows.push_back({shortest(c.r) + " / " + shortest(c.R), shortest(c.step),
                        fixed(100 * errors(StepLaw::variable_angle).chord, 4) + " %",
                        left < 1e-11 ? "below 1e-11" : fixed(left, 12), fixed(100 * inverted.chord, 4) + " %"});
    }
    return "Law (24) is Euler's method. What is left after inversion of the arc length is the chord's own, "
           "κ²Δs²/24.\n\n" +
           markdown_table(rows);
}

std::string poses() {
    Rows rows{{"r / R, mm", "opening at the side, °", "δ by (12), °", "bisector, °"}};
    for (const double r : {150.0, 540.0}) {
        const SaddlePoint side = pipes(600, r).at(kPi / 2);
        rows.push_back({shortest(r) + " / 600", fixed(side.opening / kDegree, 2),
                        fixed(torch_angle(side, PoseLaw::paper, kPi / 4) / kDegree, 2),
                        fixed(torch_angle(side, PoseLaw::bisector, 0) / kDegree, 2)});
    }
    return "Both torch angles are from the branch's wall. The paper's law keeps the angle to the header's wall; the "
           "bisector halves the opening, and is the default. It leaves the plane through the branch's axis by up to " +
           fixed(off_meridian(pipes(600, 150)) / kDegree, 2) + "° (150 / 600).\n\n" + markdown_table(rows);
}

/// What the program says to pipes that don't meet all round.
std::string refusal(double R, double r, double offset) {
    try {
        pipes(R, r, 90, offset);
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

std::string general_position() {
    Rows rows{{"r / R, mm", "angle, °", "offset, mm", "length, mm", "by bisection", "opening, °", "curvature, 1/mm"}};
    struct Case {
        double R, r, angle_deg, offset;
    };
    for (const Case& c : {Case{600, 150, 90, 0}, Case{600, 150, 60, 80}, Case{200, 100, 60, 80}, Case{300, 270, 45, 0},
                          Case{300, 100, 90, 195}}) {
        const SaddleCurve curve = pipes(c.R, c.r, c.angle_deg, c.offset);
        Range opening, bend;
        for (int k = 0; k < 36000; ++k) {
            const SaddlePoint s = curve.at(2 * kPi * k / 36000);
            opening.add(s.opening / kDegree);
            bend.add(s.curvature_per_mm);
        }
        const double angle = c.angle_deg * kDegree;
        const SaddleOracle oracle(curve.branch(), {0, std::sin(angle), -std::cos(angle)},
                                  Cylinder{{0, 0, 0}, {0, 1, 0}, c.R});
        rows.push_back({shortest(c.r) + " / " + shortest(c.R), shortest(c.angle_deg), shortest(c.offset),
                        fixed(curve.length(), 4), fixed(oracle.length(), 4), range_text(opening.low, opening.high, 2),
                        range_text(bend.low, bend.high, 5)});
    }
    return "The paper's saddle is upright and central. Any angle and offset, and other headers, are one quadratic for "
           "each "
           "generator line of the branch; lengths by bisection in long double know none of its formulas.\n\n" +
           markdown_table(rows) +
           "Where that quadratic has no root there is no seam all round, and the program says: *" +
           refusal(300, 100, 201) + "*.\n\n";
}

std::string groove_passes() {
    const SeamModel model = nominal_model(pipes(600, 150), PoseLaw::bisector, 0);
    PlanOptions options;
    options.groove = GrooveForm::fillet;
    options.groove_depth_mm = 8;
    options.bead_area_mm2 = 20;
    Rows rows{{"pass", "layer", "across, mm", "up, mm", "lean, °", "section, mm²"}};
    double area = 0;
    for (const PlannedPass& pass : plan(std::vector{model}, options).passes) {
        rows.push_back({std::to_string(rows.size()), std::to_string(pass.layer + 1), fixed(pass.across_mm, 2),
                        fixed(pass.up_mm, 2), fixed(pass.tilt_rad / kDegree, 1),
                        fixed(pass.least_mm2, 1) + " to " + fixed(pass.most_mm2, 1)});
        area += pass.area_mm2;
    }
    return "The introduction asks for several layers according to the form of the groove, and gives no rule. A fillet "
           "8 mm deep round 150 / 600 has a section of h² tan(ψ/2), " +
           fixed(area, 1) + " mm² in the mean; in beads of 20 mm², twice as wide as high, that is\n\n" +
           markdown_table(rows) +
           "Across counts towards the branch, up along the bisector, the lean of the torch towards the branch; every "
           "pass takes the same share of the section all the way round, as it opens and closes.\n\n"
           "    build/seampath saddle --header-radius-mm 600 --branch-radius-mm 150 --groove fillet --groove-depth-mm "
           "8 "
           "\\\n        --bead-area-mm2 20 --out out/passes\n\n"
           "A saddle that `seampath run` fitted to a scan is held against its drawing, dimension by dimension and "
           "along the seam, where it is out of round included, by\n\n"
           "    build/seampath saddle --from out/part --header-radius-mm 60 --branch-radius-mm 30 --out "
           "out/as-built\n\n";
}

}  // namespace

std::string saddle_section() {
    return "## The saddle-shaped weld\n\n"
           "L. Xue, M. Wei, T. Yang, Y. Lu, N. Shi, Z. Zhang, Interpolation Algorithm and Mathematical Model in "
           "Automated "
           "Welding of Saddle-Shaped Weld, 2018.\n\n"
           "    build/seampath saddle --header-radius-mm 600 --branch-radius-mm 150 --step equal-angle --pose paper "
           "--out "
           "out/saddle\n\n" +
           table_1() + speeds() + poses() + general_position() + groove_passes() +
           "Misprints: (2) is x′ = x cos Δ + y sin Δ, y′ = y cos Δ − x sin Δ; (5) is y² − z² = r² − R²; (10) has no "
           "absolute "
           "value; (20) lacks the sign of x. (23) and (24) are right but have a pole at θ = 90°; |dp/dθ| has none.\n\n";
}

}  // namespace seampath
