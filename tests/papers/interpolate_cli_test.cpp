#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/spawn.hpp"
#include "tests/papers/tables.hpp"

namespace seampath {
namespace interpolate_cli_test {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::json;
using Words = std::vector<std::string>;

Outcome interpolate_program(Words more) {
    more.insert(more.begin(), "interpolate");
    return seampath_program(more);
}

Json json_of(Words words) {
    words.emplace_back("--json");
    const Outcome run = interpolate_program(words);
    EXPECT_EQ(run.status, 0) << run.err;
    return Json::parse(run.out);
}

const std::string kTwo = paper_file("minejeva_table_2.csv");
const std::string kFour = paper_file("minejeva_table_4.csv");
const std::string kChecks = paper_file("minejeva_check_points.csv");

TEST(InterpolateCli, RanksAllMethodsOnThePapersSeam) {
    const Json json = json_of({kFour, "--check", kChecks, "--degree", "11", "--parametrization", "chord,foley"});
    std::vector<std::string> order;
    std::map<std::string, Json> check;
    for (const auto& method : json.at("methods")) {
        order.push_back(method.at("method"));
        check[order.back()] = method.at("check");
    }
    EXPECT_THAT(order, testing::ElementsAre("parametric (chord)", "parametric (foley)", "pchip", "akima", "not-a-knot",
                                            "clamped", "natural", "linear", testing::_, testing::_));
    EXPECT_NEAR(check.at("natural").at("mean").get<double>(), 0.0804, 5e-5);
    EXPECT_NEAR(check.at("natural").at("variance_n").get<double>(), 2.6406e-3, 5e-8);
    EXPECT_NEAR(check.at("natural").at("variance_n_1").get<double>(), 2.7959e-3, 5e-8);
    EXPECT_NEAR(check.at("natural").at("root_variance_n").get<double>(), 0.0514, 5e-5);
    EXPECT_NEAR(check.at("newton-divided").at("max").get<double>(), 1.601, 5e-4);
    EXPECT_EQ(json.at("left_out").size(), 6u) << "equal steps are asked for by five, equal ends by one";
}

TEST(InterpolateCli, TextShowsRankingWarningsAndReasons) {
    const Outcome run = interpolate_program({kFour, "--check", kChecks});
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_THAT(
        run.out,
        AllOf(HasSubstr("12 rows, unequal steps, 2 inflections at x = 3.723, 8.952"),
              HasSubstr("1  parametric (chord)  0.0338"),
              HasSubstr("natural: runs against the data from x = 1.828 to 2.062, with slope -0.0236 at x = 1.932"),
              HasSubstr("left out: newton-forward, newton-backward, stirling, bessel, classical: "),
              HasSubstr("left out: periodic")));
}

TEST(InterpolateCli, PrintsThePapersPolynomialAndDifferences) {
    const Json json = json_of({kTwo, "--method", "newton-forward,classical", "--at", "1,5", "--differences"});
    const auto a = json.at("polynomial").get<std::vector<double>>();
    ASSERT_EQ(a.size(), 6u);
    EXPECT_NEAR(a[5], 17.0 / 25600, 1e-15);
    EXPECT_NEAR(a[2], -107.0 / 80, 1e-14);
    EXPECT_NEAR(json.at("differences")[4][0].get<double>(), 2.55, 1e-14);
    const Json& forward = json.at("methods")[0].at("values");
    EXPECT_NEAR(forward[0].at("y").get<double>(), 2.7064453125, 1e-12);
    EXPECT_TRUE(forward[0].at("estimated_error").is_null());
    EXPECT_EQ(json.at("methods")[1].at("values")[1].at("formula"), "bessel");
    EXPECT_EQ(json.at("methods")[1].at("values")[1].at("x0"), 4);
    const Outcome text = interpolate_program({kTwo, "--method", "newton-forward", "--at", "1", "--differences"});
    EXPECT_THAT(text.out, AllOf(HasSubstr("0     0     3.9   -3.2   2.9   -2.7   2.55"), HasSubstr("2.706445313"),
                                HasSubstr("0 3.825833333 -1.3375 0.2377604167 -0.0203125 0.0006640625")));
}

TEST(InterpolateCli, SplitsAtInflections) {
    const TestFolder folder;
    const std::string file = folder.path() / "sine.csv";
    std::ofstream out(file);
    for (int i = 0; i <= 16; ++i) {
        out << 0.5 * i << ',' << std::sin(0.5 * i) << '\n';
    }
    out.close();
    const Json json = json_of({file, "--method", "bessel", "--split", "inflections"});
    ASSERT_EQ(json.at("inflections").size(), 2u);
    EXPECT_NEAR(json.at("inflections")[0].at("x").get<double>(), M_PI, 0.01);
    EXPECT_EQ(json.at("inflections")[1].at("node_x"), 6.5);
    EXPECT_THAT(interpolate_program({file, "--split", "inflections"}).out, HasSubstr("polynomials are split there"));
}

TEST(InterpolateCli, DrawsAllLines) {
    const TestFolder folder;
    const auto file = folder.path() / "plot.svg";
    const Outcome run = interpolate_program({kFour, "--method", "natural,pchip", "--check", kChecks, "--out", file});
    EXPECT_EQ(run.status, 0) << run.err;
    const std::string svg = text_of(file);
    EXPECT_THAT(svg,
                AllOf(testing::StartsWith("<svg xmlns=\"http://www.w3.org/2000/svg\""), HasSubstr(">natural</text>"),
                      HasSubstr(">pchip</text>"), HasSubstr("x_cm"), Not(HasSubstr("nan"))));
    std::size_t dots = 0;
    for (auto at = svg.find("<circle"); at != std::string::npos; at = svg.find("<circle", at + 1)) {
        ++dots;
    }
    EXPECT_EQ(dots, 12u + 18u);
}

TEST(InterpolateCli, SaysWhatIsWrongAndWhere) {
    const TestFolder folder;
    const auto file = [&](const std::string& name, const std::string& text) {
        std::ofstream(folder.path() / name) << text;
        return (folder.path() / name).string();
    };
    const std::string repeated = file("repeated.csv", "x,y\n0,1\n2,1\n2,3\n"),
                      falling = file("falling.csv", "3,1\n2,1\n"), wide = file("wide.csv", "1,2,3\n"),
                      one = file("one.csv", "1,2\n"), huge = file("huge.csv", "1e200,1\n2e200,2\n"),
                      word = file("word.csv", "0,1\n1,abc\n"), outside = file("outside.csv", "x,y\n3,4\n11,2\n");
    const std::vector<std::pair<Words, std::string>> cases{
        {{repeated}, repeated + ":4: x = 2 after x = 2 in line 3; x must ascend"},
        {{falling}, falling + ":2: x = 2 after x = 3 in line 1"},
        {{wide}, wide + ":1: 3 columns; two, x and y, were needed"},
        {{one}, one + ":1: the only row of numbers; at least 2 were needed"},
        {{word}, word + ":2: column 2: \"abc\" is no finite number"},
        {{kFour, "--check", outside}, outside + ":3: x = 11 lies outside the table, which goes from 0 to 10"},
        {{kFour, "--method", "bessel"}, "the step from row 5 to row 6 is 2 where the median step is 0.5;"},
        {{kFour, "--method", "periodic"}, "from y = 0 to y = 15.5; at least 4 rows and equal ends were needed"},
        {{kFour, "--method", "spline"}, "--method: \"spline\" is unknown; there are newton-forward, "},
        {{kFour, "--method", "perodic"}, "did you mean \"periodic\"?"},
        {{kFour, "--parametrization", "cord"}, "did you mean \"chord\"?"},
        {{kFour, "--at", "-1"}, "--at: -1 lies outside the table"},
        {{kFour, "--degree", "0"}, "--degree: 0 is not between 1 and 40"},
        {{kFour, "--split", "nodes"}, "--split: \"nodes\" is unknown"},
        {{kFour, "--end-slopes", "1"}, "--end-slopes: 1 numbers; two were needed"},
        {{kFour, "--method", "clamped", "--end-slopes", "nan,1"}, "an end slope is nan; finite numbers"},
        {{huge}, "row 1 is not finite or beyond 1e100"},
        {{kFour, "--out", folder.path()}, "is no file name"}};
    for (const auto& [words, message] : cases) {
        const Outcome run = interpolate_program(words);
        EXPECT_EQ(run.status, 2) << message;
        EXPECT_THAT(run.err, HasSubstr(message));
        EXPECT_EQ(run.out, "") << message;
    }
}

}  // namespace interpolate_cli_test
}  // namespace seampath
