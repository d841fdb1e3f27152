#include "stages/geometry/differences.hpp"

#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/error.hpp"
#include "stages/geometry/polynomial.hpp"
#include "tests/papers/tables.hpp"

namespace seampath {
namespace differences_test {

using testing::HasSubstr;
using Values = std::vector<double>;

constexpr std::array kFormulas{Formula::newton_forward, Formula::newton_backward, Formula::stirling, Formula::bessel};

Values equal_steps(std::size_t count, double first, double step) {
    Values x;
    for (std::size_t i = 0; i < count; ++i) {
        x.push_back(first + static_cast<double>(i) * step);
    }
    return x;
}

/// The node indices that a placement's polynomial passes through, from the differences in its formula.
std::size_t first_node(const Placement& at) {
    switch (at.formula) {
        case Formula::newton_forward:
            return at.origin;
        case Formula::newton_backward:
            return at.origin - at.degree;
        case Formula::stirling:
            return at.origin - at.degree / 2;
        case Formula::bessel:
            return at.origin - (at.degree - 1) / 2;
    }
    return 0;
}

long double lagrange(const Values& x, const Values& y, std::size_t first, std::size_t count, long double at) {
    long double sum = 0;
    for (std::size_t i = first; i < first + count; ++i) {
        long double term = y[i];
        for (std::size_t j = first; j < first + count; ++j) {
            term *= j == i ? 1 : (at - x[j]) / (static_cast<long double>(x[i]) - x[j]);
        }
        sum += term;
    }
    return sum;
}

TEST(Minejeva, DifferencesOfTableThree) {
    const DifferenceTable table(paper_column("minejeva_table_2.csv", 0), paper_column("minejeva_table_2.csv", 1), 5);
    const std::vector<Values> printed{
        {3.9, 0.7, 0.4, 0.3, 0.25}, {-3.2, -0.3, -0.1, -0.05}, {2.9, 0.2, 0.05}, {-2.7, -0.15}, {2.55}};
    ASSERT_EQ(table.max_order(), 5u);
    for (std::size_t order = 1; order <= 5; ++order) {
        for (std::size_t i = 0; i < printed[order - 1].size(); ++i) {
            EXPECT_NEAR(table(order, i), printed[order - 1][i], 1e-14) << order << ", " << i;
        }
    }
}

TEST(Minejeva, PolynomialOfEquationEighteen) {
    const Values x = paper_column("minejeva_table_2.csv", 0), y = paper_column("minejeva_table_2.csv", 1);
    const auto a = power_coefficients(x, divided_differences(x, y));
    const Values exact{0, 4591.0 / 1200, -107.0 / 80, 913.0 / 3840, -13.0 / 640, 17.0 / 25600};
    ASSERT_EQ(a.size(), 6u);
    for (std::size_t k = 0; k < 6; ++k) {
        EXPECT_NEAR(a[k], exact[k], 1e-14) << k;
    }
    const DifferenceTable table(x, y, 6);
    for (const Formula formula : {Formula::newton_forward, Formula::newton_backward, Formula::bessel}) {
        EXPECT_NEAR(value(table, place(table, formula, 1, 5)), 2.7064453125, 1e-14) << name(formula);
        EXPECT_NEAR(2.95 - value(table, place(table, formula, 1, 5)), 0.2436, 5e-5) << "2.44 mm, as printed";
    }
}

// Each formula term by term against Lagrange's in long double, through the nodes whose differences it takes.
TEST(Differences, EveryFormulaIsThePolynomialThroughItsNodes) {
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    for (const std::size_t count : {2u, 3u, 4u, 7u, 12u}) {
        const Values x = equal_steps(count, -1.5, 0.25);
        Values y(count);
        std::generate(y.begin(), y.end(), [&] { return normal(random); });
        for (std::size_t degree = 1; degree <= 9; ++degree) {
            const DifferenceTable table(x, y, degree + 1);
            for (const Formula formula : kFormulas) {
                for (double at = x.front(); at <= x.back(); at += 0.0625) {
                    const Placement p = place(table, formula, at, degree);
                    const std::size_t first = first_node(p);
                    ASSERT_LE(first + p.degree, count - 1);
                    const std::size_t i = table.interval(at);
                    const bool nearest_only = p.formula == Formula::stirling;
                    EXPECT_TRUE(first <= i + nearest_only && i + 1 <= first + p.degree + nearest_only);
                    EXPECT_NEAR(value(table, p), static_cast<double>(lagrange(x, y, first, p.degree + 1, at)), 1e-11)
                        << name(formula) << " of degree " << p.degree << " at " << at << " of " << count;
                }
            }
        }
    }
}

// With y = x^(n+1) the derivative in (14)-(17) is (n+1)! everywhere, so the error terms are exact.
TEST(Differences, ErrorTermsAreExactForOneDegreeMore) {
    const Values x = equal_steps(9, 1, 0.5);
    for (std::size_t degree = 1; degree <= 6; ++degree) {
        for (const Formula formula : kFormulas) {
            for (const double at : {1.1, 2.3, 2.8, 3.05, 4.9}) {
                const Placement shape = place(DifferenceTable(x, x, 8), formula, at, degree);
                const double order = static_cast<double>(shape.degree) + 1;
                Values y;
                for (const double v : x) {
                    y.push_back(std::pow(v, order));
                }
                const DifferenceTable table(x, y, 8);
                const double error = std::pow(at, order) - value(table, shape);
                const double term = error_factor(shape) * std::pow(0.5, order) * std::tgamma(order + 1);
                EXPECT_NEAR(error, term, 1e-9 * std::pow(at, order)) << name(formula) << ' ' << degree << ' ' << at;
                ASSERT_TRUE(estimated_error(table, shape).has_value());
                EXPECT_NEAR(*estimated_error(table, shape), std::abs(error), 1e-9 * std::pow(at, order));
            }
        }
    }
}

TEST(Differences, EstimatedErrorIsThatOfSmoothFunctions) {
    const Values x = equal_steps(21, 0, 0.3);
    Values y;
    for (const double v : x) {
        y.push_back(std::sin(v));
    }
    const DifferenceTable table(x, y, 6);
    for (double at = 0.05; at < 6; at += 0.1) {
        const Placement p = choose(table, at, 5);
        const double error = std::abs(std::sin(at) - value(table, p));
        EXPECT_LT(error, 1.5 * *estimated_error(table, p) + 2e-8) << at;
    }
    const DifferenceTable whole(std::span{x}.first(6), std::span{y}.first(6), 6);
    EXPECT_FALSE(estimated_error(whole, choose(whole, 0.4, 5))) << "no sixth difference in six values";
}

// Section VI: Newton I above, II below, Stirling's near nodes and Bessel's between them in the centre.
TEST(Differences, ChoosesTheFormulaThatThePaperRecommends) {
    const Values x = equal_steps(11, 0, 1);
    const DifferenceTable table(x, x, 6);
    const auto expect = [&](double at, Formula formula, std::size_t origin, double u, std::size_t degree) {
        const Placement p = choose(table, at, 5);
        EXPECT_EQ(name(p.formula), name(formula)) << at;
        EXPECT_EQ(p.origin, origin) << at;
        EXPECT_DOUBLE_EQ(p.u, u) << at;
        EXPECT_EQ(p.degree, degree) << at;
    };
    expect(0, Formula::newton_forward, 0, 0, 5);
    expect(0.5, Formula::newton_forward, 0, 0.5, 5);
    expect(1.5, Formula::newton_forward, 1, 0.5, 5);
    expect(1.875, Formula::stirling, 2, -0.125, 4);
    expect(5.125, Formula::stirling, 5, 0.125, 4);
    expect(5.25, Formula::bessel, 5, 0.25, 5);
    expect(5.75, Formula::bessel, 5, 0.75, 5);
    expect(5.875, Formula::stirling, 6, -0.125, 4);
    expect(8.125, Formula::stirling, 8, 0.125, 4);
    expect(8.5, Formula::newton_backward, 9, -0.5, 5);
    expect(9.5, Formula::newton_backward, 10, -0.5, 5);
    expect(10, Formula::newton_backward, 10, 0, 5);
}

TEST(Differences, ShortTablesAreServedAtTheirFullDegree) {
    const DifferenceTable table(Values{0, 1, 2}, Values{0, 1, 4}, 6);
    for (double at = 0; at <= 2; at += 0.125) {
        EXPECT_DOUBLE_EQ(value(table, choose(table, at, 5)), at * at);
    }
}

TEST(Differences, UnequalStepsAreAnErrorThatNamesTheRows) {
    try {
        const DifferenceTable table(Values{0, 1, 2, 3.5, 4}, Values{0, 0, 0, 0, 0}, 5);
        FAIL() << "no error";
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("from row 3 to row 4 is 1.5 where the median step is 1; finite differences "
                                            "need equal steps; use newton-divided"));
    }
    try {
        const DifferenceTable table(Values{0, 1, 3, 4, 5}, Values{0, 0, 0, 0, 0}, 5);
        FAIL() << "no error";
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("from row 2 to row 3 is 2 where")) << "the odd one, not the first";
    }
    Values tenths;
    for (int i = 0; i < 1000; ++i) {
        tenths.push_back(1000 + i / 10.0);
    }
    EXPECT_NO_THROW(DifferenceTable(tenths, tenths, 3)) << "equal but for rounding";
}

TEST(Polynomial, NewtonAndLagrangeAreOne) {
    const Values x{0.3, -2, 5, 1.1, 0.9}, y{1, -4, 2, 0.5, 3};
    const auto difference = divided_differences(x, y);
    for (const double at : {-2.0, -1.3, 0.3, 0.31, 4.0, 7.0}) {
        const auto exact = static_cast<double>(lagrange(x, y, 0, 5, at));
        EXPECT_NEAR(newton_value(x, difference, at), exact, 1e-11);
        EXPECT_NEAR(lagrange_value(x, y, at), exact, 1e-11);
        double sum = 0, power = 1;
        for (const double a : power_coefficients(x, difference)) {
            sum += a * power;
            power *= at;
        }
        EXPECT_NEAR(sum, exact, 1e-10);
    }
}

TEST(Polynomial, NodesOfAllDistancesAreServed) {
    const Values x{-5.4e10, -3, 0, 3.3e-14, 0.4, 1}, y{1, -2, 0, 1, 3, 1};
    for (const double at : {-4e10, -1e10, -5.0, 1e-14, 0.7}) {
        const auto exact = static_cast<double>(lagrange(x, y, 0, 6, at));
        EXPECT_NEAR(lagrange_value(x, y, at) / exact, 1, 1e-12) << at;
        EXPECT_NEAR(newton_value(x, divided_differences(x, y), at) / exact, 1, 1e-12) << at;
    }
}

}  // namespace differences_test
}  // namespace seampath
