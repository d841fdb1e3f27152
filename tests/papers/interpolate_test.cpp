#include "stages/geometry/interpolate.hpp"

#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/error.hpp"
#include "stages/geometry/interpolation_check.hpp"
#include "tests/papers/tables.hpp"

namespace seampath {
namespace interpolate_test {

using Eigen::Vector2d;
using testing::HasSubstr;
using Values = std::vector<double>;

struct TableFour {
    Values x = paper_column("minejeva_table_4.csv", 0);
    Values y = paper_column("minejeva_table_4.csv", 1);
    std::vector<Vector2d> checks;

    TableFour() {
        for (const auto& point : paper_points("minejeva_check_points.csv")) {
            checks.emplace_back(point);
        }
    }
    Interpolant line(Method method, const InterpolateOptions& options = {}) const {
        return interpolate(method, x, y, options);
    }
    CheckStatistics statistics(Method method, const InterpolateOptions& options = {}) const {
        return check_points(line(method, options), checks);
    }
    Shape shape(Method method, const InterpolateOptions& options = {}) const {
        return shape_of(line(method, options), x, y);
    }
};

InterpolateOptions of_degree(std::size_t degree) {
    InterpolateOptions options;
    options.degree = degree;
    return options;
}

InterpolateOptions over(Objective objective) {
    InterpolateOptions options;
    options.parametrization = objective;
    return options;
}

TEST(Minejeva, NaturalSplineOfTableFour) {
    const CheckStatistics s = TableFour().statistics(Method::natural);
    ASSERT_EQ(s.error.size(), 18u);
    EXPECT_NEAR(s.mean, 0.0804, 5e-5);
    EXPECT_NEAR(s.variance, 2.6406e-3, 5e-8);
    EXPECT_NEAR(*s.sample_variance, 2.7959e-3, 5e-8);
    EXPECT_NEAR(std::sqrt(s.variance), 0.0514, 5e-5);
    EXPECT_NEAR(std::sqrt(*s.sample_variance), 0.0529, 5e-5);
    EXPECT_NEAR(s.rms, 0.0954, 5e-5);
    EXPECT_NEAR(s.max, 0.1782, 5e-5);
    EXPECT_EQ(s.max_x, 0.7);
}

TEST(Minejeva, OtherMethodsOnTableFour) {
    struct Row {
        Method method;
        InterpolateOptions options;
        double mean, max;
    };
    const TableFour table;
    const std::vector<Row> rows{{Method::not_a_knot, {}, .0718, .1465},
                                {Method::akima, {}, .0487, .1042},
                                {Method::pchip, {}, .0410, .1343},
                                {Method::linear, {}, .1019, .25},
                                {Method::newton_divided, of_degree(11), .3412, 1.601},
                                {Method::lagrange, of_degree(11), .3412, 1.601},
                                {Method::parametric, over(Objective::chord), .0338, .1352},
                                {Method::parametric, over(Objective::foley), .0382, .1271},
                                {Method::parametric, over(Objective::exact), .0367, .1459}};
    for (const Row& row : rows) {
        const CheckStatistics s = table.statistics(row.method, row.options);
        EXPECT_NEAR(s.mean, row.mean, 5.1e-5) << name(row.method);
        EXPECT_NEAR(s.max, row.max, row.max > 1 ? 5e-4 : 5.1e-5) << name(row.method);
    }
}

TEST(Minejeva, NaturalSplineOfTableFourIsNotMonotone) {
    const TableFour table;
    const Shape natural = table.shape(Method::natural);
    ASSERT_EQ(natural.reversals.size(), 1u);
    EXPECT_NEAR(natural.reversals[0].slope, -0.0236, 5e-5);
    EXPECT_NEAR(natural.reversals[0].x, 1.93, 5e-3);
    EXPECT_NEAR(natural.reversals[0].from_x, 1.83, 0.016);
    EXPECT_NEAR(natural.reversals[0].to_x, 2.06, 0.032);
    EXPECT_EQ(natural.data_turns, 0);
    EXPECT_EQ(natural.turns, 2);
    EXPECT_GT(natural.overshoot, 0);
    for (const Method method : {Method::pchip, Method::linear}) {
        const Shape shape = table.shape(method);
        EXPECT_TRUE(shape.reversals.empty()) << name(method);
        EXPECT_EQ(shape.turns, 0) << name(method);
        EXPECT_EQ(shape.overshoot, 0) << name(method);
        EXPECT_EQ(shape.jump, 0) << name(method);
    }
    const Shape newton = table.shape(Method::newton_divided, of_degree(11));
    EXPECT_GT(newton.turns, 2);
    EXPECT_GT(newton.overshoot, 1);
}

TEST(Interpolate, EveryMethodPassesEveryNode) {
    Values x, y;
    for (int i = 0; i <= 12; ++i) {
        x.push_back(0.5 * i);
        y.push_back(i == 12 ? 0 : std::sin(0.5 * i) + 0.1 * (i % 3));
    }
    InterpolateOptions split;
    split.split_at_inflections = true;
    for (std::size_t m = 0; m < kMethodNames.size(); ++m) {
        for (const auto& options : {InterpolateOptions{}, of_degree(1), of_degree(4), of_degree(12), split}) {
            const Interpolant line = interpolate(static_cast<Method>(m), x, y, options);
            for (std::size_t i = 0; i < x.size(); ++i) {
                EXPECT_NEAR(line.value(x[i]), y[i], 1e-11) << kMethodNames[m];
                EXPECT_NEAR((line.at(line.t[i]) - Vector2d(x[i], y[i])).norm(), 0, 1e-11) << kMethodNames[m];
            }
        }
    }
}

TEST(Interpolate, TwoRowsAreALine) {
    const Values x{1, 3}, y{5, 1};
    for (std::size_t m = 0; m < kMethodNames.size(); ++m) {
        if (static_cast<Method>(m) != Method::periodic) {
            EXPECT_NEAR(interpolate(static_cast<Method>(m), x, y, {}).value(1.5), 4, 1e-12) << kMethodNames[m];
        }
    }
}

// Its end slopes are those of parabolas through three rows, or as asked for.
TEST(Interpolate, ClampedRepeatsAParabola) {
    const auto f = [](double v) { return 3 - 2 * v + 0.5 * v * v; };
    Values x{-1, 0.5, 0.7, 3, 4}, y;
    std::transform(x.begin(), x.end(), std::back_inserter(y), f);
    InterpolateOptions slopes;
    slopes.end_slopes = {-3, 2};  // f'
    for (double at = -1; at <= 4; at += 0.1) {
        EXPECT_NEAR(interpolate(Method::clamped, x, y, {}).value(at), f(at), 1e-13) << at;
        EXPECT_NEAR(interpolate(Method::clamped, x, y, slopes).value(at), f(at), 1e-13) << at;
    }
    slopes.end_slopes = {0, 2};
    EXPECT_GT(std::abs(interpolate(Method::clamped, x, y, slopes).value(-0.5) - f(-0.5)), 0.1);
}

// The mirror image of a table gives the mirror image of the line.
TEST(Interpolate, MirrorsWithTheTable) {
    const TableFour table;
    Values x(table.x.rbegin(), table.x.rend()), y(table.y.rbegin(), table.y.rend());
    std::transform(x.begin(), x.end(), x.begin(), [](double v) { return -v; });
    for (const Method method : {Method::lagrange, Method::newton_divided, Method::natural, Method::clamped,
                                Method::not_a_knot, Method::akima, Method::pchip, Method::linear, Method::parametric}) {
        const Interpolant line = table.line(method), mirrored = interpolate(method, x, y, {});
        for (double at = 0.03; at < 10; at += 0.37) {
            EXPECT_NEAR(line.value(at), mirrored.value(-at), 1e-10) << name(method) << ' ' << at;
        }
    }
}

TEST(Interpolate, ClassicalTellsItsFormulaAndError) {
    Values x, y;
    for (int i = 0; i <= 10; ++i) {
        x.push_back(i);
        y.push_back(std::exp(-0.3 * i));
    }
    const Evaluation e = interpolate(Method::classical, x, y, {}).evaluate(4.5);
    ASSERT_TRUE(e.placement && e.estimated_error);
    EXPECT_EQ(e.placement->formula, Formula::bessel);
    EXPECT_NEAR(e.y, std::exp(-1.35), 2 * *e.estimated_error);
    EXPECT_GT(shape_of(interpolate(Method::classical, x, y, {}), x, y).jump, 0)
        << "polynomials of other degrees don't meet";
}

TEST(Inflections, AreFoundInTheData) {
    Values x, y;
    for (int i = 0; i <= 20; ++i) {
        x.push_back(0.5 * i);
        y.push_back(std::sin(0.5 * i));
    }
    const auto found = inflections(x, y);
    ASSERT_EQ(found.size(), 3u);
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(found[k].x, M_PI * static_cast<double>(k + 1), 0.01);
        EXPECT_NEAR(x[found[k].node], found[k].x, 0.25 + 1e-9);
    }
    EXPECT_TRUE(inflections(paper_column("minejeva_table_2.csv", 0), paper_column("minejeva_table_2.csv", 1)).empty());
    EXPECT_TRUE(inflections(Values{0, 0.1, 0.2, 0.3, 0.7}, Values{0.3, 0.4, 0.5, 0.6, 1.0}).empty()) << "straight";
    EXPECT_EQ(inflections(Values{0, 1, 2, 3, 4, 5}, Values{0, 0, 1, 2, 3, 3}).at(0).x, 2.5) << "middle of a straight";
}

// Runge's function: polynomials that reach across its inflection points swing, those that end there don't.
TEST(Interpolate, SplittingTamesPolynomials) {
    Values x, y;
    for (int i = -10; i <= 10; ++i) {
        x.push_back(0.1 * i);
        y.push_back(1 / (1 + 25 * 0.01 * i * i));
    }
    std::vector<Vector2d> checks;
    for (int i = -99; i <= 99; i += 2) {
        checks.emplace_back(0.01 * i, 1 / (1 + 25 * 1e-4 * i * i));
    }
    InterpolateOptions options = of_degree(20);
    const double whole = check_points(interpolate(Method::newton_forward, x, y, options), checks).max;
    options.split_at_inflections = true;
    const double split = check_points(interpolate(Method::newton_forward, x, y, options), checks).max;
    EXPECT_GT(whole, 1);
    EXPECT_LT(split, 0.02);
}

TEST(Interpolate, DistanceIsTheShortest) {
    const TableFour table;
    for (const Method method : {Method::natural, Method::linear, Method::parametric}) {
        const Interpolant line = table.line(method);
        const CheckStatistics s = check_points(line, table.checks);
        for (std::size_t i = 0; i < table.checks.size(); ++i) {
            double brute = 1e9;
            for (std::size_t k = 0; k + 1 < line.t.size(); ++k) {
                for (int j = 0; j <= 4000; ++j) {
                    const double t = line.t[k] + (line.t[k + 1] - line.t[k]) * j / 4000;
                    brute = std::min(brute, (line.at(t) - table.checks[i]).norm());
                }
            }
            EXPECT_NEAR(s.distance[i], brute, 1e-4) << name(method);
            EXPECT_LE(s.distance[i], brute + 1e-9) << name(method);
            EXPECT_LE(s.distance[i], s.error[i]) << name(method);
        }
    }
}

// Of data that scatter far more than their steps, |e| reaches across the whole table, but the line is near.
TEST(Interpolate, DistancesFromWildLinesAreFoundNearby) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> any(0, 1e6);
    Values x, y;
    std::vector<Vector2d> checks;
    for (int i = 0; i < 400; ++i) {
        x.push_back(i);
        y.push_back(any(random));
        checks.emplace_back(std::min(i + 0.5, 399.0), any(random));
    }
    Interpolant line = interpolate(Method::linear, x, y, {});
    std::size_t looks = 0;
    line.at = [at = line.at, &looks](double t) {
        ++looks;
        return at(t);
    };
    const CheckStatistics s = check_points(line, checks);
    EXPECT_LT(looks, 10000 * checks.size()) << "a hundred thousand for each when all within |e| is looked at";
    for (std::size_t i = 0; i < checks.size(); i += 10) {
        double exact = 1e9;
        for (std::size_t k = 0; k + 1 < x.size(); ++k) {
            const Vector2d a(x[k], y[k]), b(x[k + 1], y[k + 1]);
            const double share = std::clamp((checks[i] - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
            exact = std::min(exact, (a + share * (b - a) - checks[i]).norm());
        }
        EXPECT_NEAR(s.distance[i], exact, 1e-5 * (1 + exact)) << i;
    }
}

TEST(Interpolate, OneCheckPointHasNoSampleVariance) {
    const TableFour table;
    const CheckStatistics s = check_points(table.line(Method::linear), std::vector{Vector2d(3, 6.2)});
    EXPECT_FALSE(s.sample_variance);
    EXPECT_EQ(s.variance, 0);
    EXPECT_NEAR(s.mean, 0.15, 1e-12);
}

TEST(Interpolate, SteepDataMayBringAParametricLineToRunBack) {
    const Values x{0, 1, 1.01, 2, 3}, y{0, 0, 5, 5, 5};
    EXPECT_TRUE(shape_of(interpolate(Method::parametric, x, y, {}), x, y).runs_back);
    EXPECT_FALSE(shape_of(interpolate(Method::natural, x, y, {}), x, y).runs_back);
}

TEST(Interpolate, LevelDataGiveALevelLine) {
    const Values x{0, 1, 2, 3}, y{5, 5, 5, 5};
    for (std::size_t m = 0; m < kMethodNames.size(); ++m) {
        const Interpolant line = interpolate(static_cast<Method>(m), x, y, {});
        EXPECT_NEAR(line.value(1.3), 5, 1e-14) << kMethodNames[m];
        const Shape shape = shape_of(line, x, y);
        EXPECT_EQ(shape.turns, 0) << kMethodNames[m];
        EXPECT_EQ(shape.overshoot, 0) << kMethodNames[m];
        EXPECT_EQ(shape.jump, 0) << kMethodNames[m];
    }
}

TEST(Interpolate, SaysWhatIsWrongWithTheTable) {
    const auto message = [](Method method, const Values& x, const Values& y, const InterpolateOptions& options = {}) {
        try {
            interpolate(method, x, y, options).value(x[0] - 1);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string("no error");
    };
    EXPECT_THAT(message(Method::natural, {1}, {1}), HasSubstr("1 rows; at least 2"));
    EXPECT_THAT(message(Method::natural, {1, 2, 2}, {1, 1, 1}),
                HasSubstr("row 3 has x = 2 after x = 2; x must ascend"));
    EXPECT_THAT(message(Method::natural, {1, 2, 0}, {1, 1, 1}), HasSubstr("row 3 has x = 0 after x = 2"));
    EXPECT_THAT(message(Method::natural, {1, NAN}, {1, 1}), HasSubstr("row 2 is not finite"));
    EXPECT_THAT(message(Method::natural, {1, 2}, {1, 1e101}), HasSubstr("row 2 is not finite or beyond 1e100"));
    EXPECT_THAT(message(Method::natural, {1, 2}, {1, 1}), HasSubstr("x = 0 lies outside the table, which goes from 1"));
    EXPECT_THAT(message(Method::parametric, {1, 2}, {1, 1}), HasSubstr("x = 0 lies outside the table"));
    EXPECT_THAT(message(Method::stirling, {1, 2, 4}, {1, 1, 1}), HasSubstr("need equal steps"));
    EXPECT_THAT(message(Method::periodic, {1, 2, 3, 4}, {1, 1, 1, 2}), HasSubstr("from y = 1 to y = 2; at least 4"));
    EXPECT_THAT(message(Method::periodic, {1, 2, 3}, {1, 2, 1}), HasSubstr("has 3 rows"));
    EXPECT_THAT(message(Method::lagrange, {1, 2}, {1, 1}, of_degree(0)), HasSubstr("degree 0; 1 to 40"));
    InterpolateOptions slopes;
    slopes.end_slopes = {0, INFINITY};
    EXPECT_THAT(message(Method::clamped, {1, 2}, {1, 1}, slopes), HasSubstr("an end slope is inf"));
}

}  // namespace interpolate_test
}  // namespace seampath
