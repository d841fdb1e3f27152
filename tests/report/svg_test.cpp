#include "pipeline/svg.hpp"

#include <algorithm>
#include <cmath>
#include <regex>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace seampath {
namespace svg_test {

using testing::DoubleNear;
using testing::Each;
using testing::ElementsAre;
using testing::Ge;
using testing::HasSubstr;
using testing::Le;

// Plot area from x = 58 to 486 and from y = 10 to 210 pixels.
const PlotAxes kAxes{500, 250, 0, 10, -1, 1, "station, mm", "deviation, mm"};

/// All coordinates in the d attribute of a path, alternating x and y.
std::vector<double> coordinates(const std::string& svg) {
    std::vector<double> numbers;
    const std::regex number("-?[0-9]+\\.[0-9]");
    for (std::sregex_iterator it(svg.begin(), svg.end(), number), end; it != end; ++it) {
        numbers.push_back(std::stod(it->str()));
    }
    return numbers;
}

std::vector<double> every_second(const std::vector<double>& all, std::size_t first) {
    std::vector<double> some;
    for (std::size_t i = first; i < all.size(); i += 2) {
        some.push_back(all[i]);
    }
    return some;
}

TEST(Svg, TicksAreRoundNumbers) {
    EXPECT_THAT(nice_ticks(0, 10, 5), ElementsAre(0, 2, 4, 6, 8, 10));
    EXPECT_THAT(nice_ticks(-0.1, 0.1, 4), ElementsAre(DoubleNear(-0.1, 1e-12), DoubleNear(-0.05, 1e-12), 0,
                                                      DoubleNear(0.05, 1e-12), DoubleNear(0.1, 1e-12)));
    EXPECT_THAT(nice_ticks(3, 188.5, 4), ElementsAre(50, 100, 150));
}

TEST(Svg, AxesCarryLabelsAndEscapedTitle) {
    const std::string svg = svg_axes(kAxes, "a < b") + svg_end();
    EXPECT_THAT(svg, HasSubstr("<title>a &lt; b</title>"));
    EXPECT_THAT(svg, HasSubstr(">station, mm<"));
    EXPECT_THAT(svg, HasSubstr(">deviation, mm<"));
    EXPECT_THAT(svg, HasSubstr(">-0.5<"));
}

TEST(Svg, PutsPointsWhereTheAxesSay) {
    const std::vector<PlotPoint> points{{0, -1}, {5, 0}, {10, 1}};
    EXPECT_THAT(svg_line(kAxes, points, "value"), HasSubstr("d=\"M66.0 210.0L276.0 110.0L486.0 10.0\""));
}

TEST(Svg, KeepsWhatLiesOutsideAtTheEdge) {
    const std::vector<PlotPoint> points{{0, -7}, {10, 7}};
    EXPECT_THAT(svg_line(kAxes, points, "value"), HasSubstr("d=\"M66.0 210.0L486.0 10.0\""));
}

TEST(Svg, BreaksLinesAndBandsWhereNothingIsKnown) {
    const double nan = std::nan("");
    const std::vector<PlotPoint> low{{0, 0}, {2, 0}, {4, nan}, {6, 0}, {8, 0}};
    std::vector<PlotPoint> high = low;
    for (PlotPoint& p : high) {
        p.y += 0.5;
    }
    const std::string line = svg_line(kAxes, low, "value"), band = svg_band(kAxes, low, high, "sigma");
    EXPECT_EQ(std::count(line.begin(), line.end(), 'M'), 2);
    EXPECT_EQ(std::count(band.begin(), band.end(), 'Z'), 2);
    EXPECT_EQ(line.find("nan"), std::string::npos);
    EXPECT_EQ(band.find("nan"), std::string::npos);
}

TEST(Svg, ThinsLongLinesWithoutLosingAnExtreme) {
    std::vector<PlotPoint> points;
    for (int i = 0; i < 100000; ++i) {
        points.push_back({i * 1e-4, i == 54321 ? 1.0 : i == 77777 ? -1.0 : 0.1 * std::sin(i * 0.01)});
    }
    const auto all = coordinates(svg_line(kAxes, points, "value"));
    const auto x = every_second(all, 0), y = every_second(all, 1);
    EXPECT_LE(x.size(), 1400U);
    EXPECT_TRUE(std::is_sorted(x.begin(), x.end()));
    EXPECT_THAT(y, Each(Ge(10.0)));
    EXPECT_THAT(y, Each(Le(210.0)));
    EXPECT_EQ(std::count(y.begin(), y.end(), 10.0), 1);
    EXPECT_EQ(std::count(y.begin(), y.end(), 210.0), 1);
}

}  // namespace svg_test
}  // namespace seampath
