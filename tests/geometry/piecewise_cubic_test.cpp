#include "stages/geometry/piecewise_cubic.hpp"

#include <cmath>
#include <functional>
#include <map>
#include <random>

#include <gtest/gtest.h>

#include "tests/papers/tables.hpp"

namespace seampath {
namespace piecewise_cubic_test {

using Values = std::vector<double>;
using Builder = std::function<PiecewiseCubic(const Values&, const Values&)>;

const std::map<std::string, Builder> kSplines{
    {"natural", [](const auto& x, const auto& y) { return natural_spline(x, y); }},
    {"clamped", [](const auto& x, const auto& y) { return clamped_spline(x, y, 20, 3); }},
    {"not-a-knot", [](const auto& x, const auto& y) { return not_a_knot_spline(x, y); }},
    {"akima", [](const auto& x, const auto& y) { return akima_spline(x, y); }},
    {"pchip", [](const auto& x, const auto& y) { return pchip_spline(x, y); }},
    {"linear", [](const auto& x, const auto& y) { return linear_spline(x, y); }}};

// Values that SciPy 1.10 gives for table IV: CubicSpline with the same ends, Akima1DInterpolator, PchipInterpolator.
TEST(PiecewiseCubic, ValuesAreThoseOfSciPy) {
    const Values x = paper_column("minejeva_table_4.csv", 0), y = paper_column("minejeva_table_4.csv", 1);
    const Values at{.05, .3, .7, 1.93, 3.1, 5.2, 7.7, 8.3, 9.9};
    const std::map<std::string, Values> scipy{
        {"natural",
         {0.9878710135052416, 4.053188799340941, 4.821827199097418, 5.901449901426744, 6.0098376923438135,
          6.4561448120189135, 7.776425209223845, 8.888336588857404, 15.176147991340335}},
        {"clamped",
         {0.9884734666712226, 4.05267845585618, 4.822065058765175, 5.901424182400107, 6.009976799800293,
          6.455948428176828, 7.776860524719106, 8.887909776504445, 15.191976603921425}},
        {"not-a-knot",
         {1.0996613601839302, 3.9584974164071385, 4.865914295880502, 5.896946090411149, 6.02795322142336,
          6.4516280228558545, 7.77711020584322, 8.887889804566848, 15.191548783186288}},
        {"akima",
         {1.1562358276643994, 3.712897081648203, 4.9385871918836255, 5.885595700851064, 6.061526486486486,
          6.454051465550057, 7.903330260349979, 8.814957575757578, 15.19584}},
        {"pchip",
         {1.0897142857142859, 3.7308239877629465, 4.974313938329249, 5.881937775351453, 6.078094999999999,
          6.425008780487806, 7.873328740936058, 8.895299647473562, 15.191326315789476}}};
    for (const auto& [name, values] : scipy) {
        const PiecewiseCubic spline = kSplines.at(name)(x, y);
        for (std::size_t i = 0; i < at.size(); ++i) {
            EXPECT_NEAR(spline.value(at[i]), values[i], 1e-12) << name << " at " << at[i];
        }
    }
    Values closed = y;
    closed.back() = 0;
    const PiecewiseCubic periodic = periodic_spline(x, closed);
    const Values values{0.6318910734865738, 4.354735722484317, 4.6813271582388944,
                        5.9163910694983635, 5.934972074190293, 6.541780209206775,
                        7.595484258171768,  9.0655290360071,   0.6699641958299356};
    for (std::size_t i = 0; i < at.size(); ++i) {
        EXPECT_NEAR(periodic.value(at[i]), values[i], 1e-12) << "periodic at " << at[i];
    }
}

TEST(PiecewiseCubic, PassesTheNodesAndBendsAsItsKindSays) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> any(0.1, 2);
    for (const std::size_t count : {2u, 3u, 4u, 5u, 20u}) {
        Values x{0}, y{1};
        while (x.size() < count) {
            x.push_back(x.back() + any(random)), y.push_back(any(random));
        }
        for (const auto& [name, build] : kSplines) {
            const PiecewiseCubic s = build(x, y);
            for (std::size_t i = 0; i < count; ++i) {
                EXPECT_NEAR(s.value(x[i]), y[i], 1e-12) << name;
                const double before = std::nextafter(x[i], -1e9);
                EXPECT_NEAR(s.value(before), y[i], 1e-12) << name;
                if (name != "linear") {
                    EXPECT_NEAR(s.slope(before), s.slope(x[i]), 1e-10) << name;
                }
                if (name == "natural" || name == "clamped" || name == "not-a-knot") {
                    EXPECT_NEAR(s.second(before), s.second(x[i]), 1e-8) << name;
                }
            }
        }
        const PiecewiseCubic natural = natural_spline(x, y);
        EXPECT_NEAR(natural.second(x.front()), 0, 1e-12);
        EXPECT_NEAR(natural.second(x.back()), 0, 1e-9);
        EXPECT_NEAR(clamped_spline(x, y, 20, 3).slope(x.front()), 20, 1e-12);
        EXPECT_NEAR(clamped_spline(x, y, 20, 3).slope(x.back()), 3, 1e-10);
        const PiecewiseCubic knot = not_a_knot_spline(x, y);
        if (count > 3) {
            EXPECT_NEAR(knot.d[0], knot.d[1], 1e-8);
            EXPECT_NEAR(knot.d[count - 3], knot.d[count - 2], 1e-8);
        }
    }
}

TEST(PiecewiseCubic, NotAKnotRepeatsACubic) {
    const auto f = [](double v) { return 2 - v + 3 * v * v - 0.5 * v * v * v; };
    for (const Values& x : {Values{0, 1, 2.5, 3}, Values{-2, 0, 0.1, 5, 6, 9}}) {
        Values y;
        std::transform(x.begin(), x.end(), std::back_inserter(y), f);
        const PiecewiseCubic s = not_a_knot_spline(x, y);
        for (double at = x.front(); at <= x.back(); at += 0.1) {
            EXPECT_NEAR(s.value(at), f(at), 1e-11);
        }
    }
}

TEST(PiecewiseCubic, PeriodicClosesSmoothly) {
    const Values x{0, 0.4, 1.1, 2, 2.2}, y{1, 3, -1, 0, 1};
    const PiecewiseCubic s = periodic_spline(x, y);
    const double end = std::nextafter(2.2, 0);
    EXPECT_NEAR(s.slope(0), s.slope(end), 1e-12);
    EXPECT_NEAR(s.second(0), s.second(end), 1e-11);
    for (std::size_t i = 1; i < 4; ++i) {
        EXPECT_NEAR(s.second(std::nextafter(x[i], 0)), s.second(x[i]), 1e-10);
    }
}

TEST(PiecewiseCubic, PchipIsMonotoneWhereDataAre) {
    const Values x{0, 1, 2, 3, 4, 5, 6}, y{0, 0.1, 5, 5, 5.1, 2, 1.9};
    const PiecewiseCubic s = pchip_spline(x, y);
    for (double at = 0; at < 6; at += 0.01) {
        const auto i = static_cast<std::size_t>(at);
        EXPECT_GE(s.slope(at) * (y[i + 1] - y[i]), -1e-12) << at;
    }
    EXPECT_EQ(s.value(2.5), 5);
}

TEST(PiecewiseCubic, AkimaKeepsStraightRunsStraight) {
    const Values x{0, 1, 2, 3, 4, 5, 6}, y{0, 1, 2, 3, 3, 3, 3};
    const PiecewiseCubic s = akima_spline(x, y);
    EXPECT_DOUBLE_EQ(s.value(0.5), 0.5);
    EXPECT_DOUBLE_EQ(s.value(5.5), 3);
}

}  // namespace piecewise_cubic_test
}  // namespace seampath
