#include "pipeline/config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "stages/error.hpp"

namespace seampath {
namespace config_test {

using testing::HasSubstr;

std::string problems(const std::string& text, const std::vector<Override>& overrides = {}) {
    try {
        parse_config(text, "cell.json", overrides);
    } catch (const InputError& error) {
        return error.what();
    }
    return "none";
}

TEST(Config, ReadsCommentsAndLeavesTheRestAtItsDefaults) {
    const Config config = parse_config("{ // torch\n \"plan\": {\"speed_mm_s\": 6 /* slow */}}", "cell.json");
    EXPECT_EQ(config.plan.speed_mm_s, 6);
    EXPECT_EQ(config.plan.air_speed_mm_s, PlanOptions().air_speed_mm_s);
}

TEST(Config, TellsAllProblemsAtOnceEachWithItsPathAndAHint) {
    const std::string text = R"({
        "plcae": {},
        "place": {"chord_tolerance": 1, "chord_tolerance_mm": -1, "speed_mm_s": 3},
        "fit": 3,
        "extract": {"joint": "filet"},
        "validate": {"min_coverage": 1.5, "tolerance_mm": "fine"},
        "export": {"robots": "abb,kuba", "base_from_scan": [1, 2], "even_if_out_of_tolerance": 1, "program_name": 7}
    })";
    EXPECT_EQ(problems(text),
              "cell.json: /plcae: there is no such section; did you mean \"place\"?\n"
              "cell.json: /place/chord_tolerance: there is no such option; did you mean \"chord_tolerance_mm\"?\n"
              "cell.json: /place/chord_tolerance_mm: -1 is not above 0\n"
              "cell.json: /place/speed_mm_s: there is no such option; did you mean /plan/speed_mm_s?\n"
              "cell.json: /fit: 3 is not an object of options\n"
              "cell.json: /extract/joint: \"filet\" is none of auto, fillet, lap, butt, v-groove, corner, saddle; "
              "did you mean \"fillet\"?\n"
              "cell.json: /validate/min_coverage: 1.5 is not between 0 and 1\n"
              "cell.json: /validate/tolerance_mm: \"fine\" is not a number\n"
              "cell.json: /export/base_from_scan: holds 2 values; 7 numbers are needed\n"
              "cell.json: /export/even_if_out_of_tolerance: 1 is neither true nor false\n"
              "cell.json: /export/program_name: 7 is not a text\n"
              "cell.json: /export/robots: \"kuba\" is no known robot; one of csv, json, abb, kuka, fanuc, ur, yaskawa, "
              "linuxcnc, ros, noether was needed");
}

TEST(Config, ChecksOverridesLikeTheFile) {
    EXPECT_EQ(problems(R"({"place": {"max_spacing_mm": -2}})", {{"--set", "place.chord_tolerance_mm", "-1"},
                                                                {"--set", "plan.sped_mm_s", "3"},
                                                                {"--set", "speed_mm_s", "3"},
                                                                {"--joint", "extract.joint", "saddel"},
                                                                {"--robot", "export.robots", "abc"}}),
              "cell.json: /place/max_spacing_mm: -2 is not above 0\n"
              "--set: /place/chord_tolerance_mm: -1 is not above 0\n"
              "--set: /plan/sped_mm_s: there is no such option; did you mean \"speed_mm_s\"?\n"
              "--set: /speed_mm_s: an option is named stage.key; did you mean /plan/speed_mm_s?\n"
              "--joint: /extract/joint: \"saddel\" is none of auto, fillet, lap, butt, v-groove, corner, saddle; "
              "did you mean \"saddle\"?\n"
              "--robot: /export/robots: \"abc\" is no known robot; one of csv, json, abb, kuka, fanuc, ur, yaskawa, "
              "linuxcnc, ros, noether was needed");
}

TEST(Config, OverridesWinOverTheFileAndTextNeedsNoQuotes) {
    const std::vector<Override> overrides{
        parse_override("plan.speed_mm_s=4.5"), parse_override("export.program_name=tee_7"),
        parse_override("export.ur_tcp=[0,0,120,0,0,0]"), parse_override("export.even_if_out_of_tolerance=true")};
    const Config config = parse_config(R"({"plan": {"speed_mm_s": 6}})", "cell.json", overrides);
    EXPECT_EQ(config.plan.speed_mm_s, 4.5);
    EXPECT_EQ(config.export_.program_name, "tee_7");
    EXPECT_EQ(parse_override("export.program_name=a=b").value, "a=b");
    EXPECT_EQ(config.export_.ur_tcp[2], 120);
    EXPECT_TRUE(config.export_.even_if_out_of_tolerance);
    EXPECT_THROW(parse_override("plan.speed_mm_s"), InputError);
    EXPECT_THAT(problems("{}", {{"--set", "export.program_name", "a\xFF"}}), HasSubstr("is not UTF-8"));
}

TEST(Config, RefusesTextThatIsNoConfig) {
    EXPECT_THAT(problems(""), HasSubstr("cell.json: /: parse error at line 1"));
    EXPECT_THAT(problems("{\"plan\": {\"speed_mm_s\": 6}"), HasSubstr("cell.json: /: parse error at line 1"));
    EXPECT_EQ(problems("[1]"), "cell.json: /: [1] is not an object with one section a stage");
    EXPECT_EQ(problems(R"({"plan": {"speed_mm_s": 6, "speed_mm_s": 7}})"),
              "cell.json: /: key \"speed_mm_s\" stands twice in one object");
    EXPECT_THAT(problems("{\"plan\": {\"speed_mm_s\": 1e999}}"), HasSubstr("number overflow"));
    EXPECT_EQ(problems("{\"plan\": " + std::string(100000, '[')), "cell.json: /: more than 64 levels of nesting");
}

TEST(Config, ResolvedTextRunsAgainUnchanged) {
    Config config;
    config.place.chord_tolerance_mm = 0.1 + 0.2;
    config.extract.joint = JointChoice::fillet;
    config.export_.base_from_scan = {1.0 / 3, -2e-300, 3, 1, 0, 0, 0};
    config.export_.program_name = "tee_7";
    const std::string text = config_json(config);
    const Config again = parse_config(text, "config.resolved.json");
    EXPECT_EQ(again.place.chord_tolerance_mm, config.place.chord_tolerance_mm);
    EXPECT_EQ(again.export_.base_from_scan, config.export_.base_from_scan);
    EXPECT_EQ(again.export_.program_name, config.export_.program_name);
    EXPECT_EQ(again.extract.joint, JointChoice::fillet);
    EXPECT_EQ(config_json(again), text);
}

TEST(Config, EveryOptionHasADefaultWithinItsBounds) {
    EXPECT_EQ(problems(config_json(Config())), "none");
}

struct Sample {
    bool flag = false;
    int count = 3;
    std::optional<double> size_mm;
    std::vector<double> list;
};

Fields describe(Sample& o) {
    return {{"flag", &o.flag, "a switch"},
            {"count", &o.count, "how many", within(1, 9)},
            {"size_mm", &o.size_mm, "how large", at_least(2)},
            {"list", &o.list, "numbers", Bounds{0, 1, true}}};
}

std::string set(Sample& sample, const std::string& key, const std::string& value) {
    try {
        const std::vector<Override> overrides{{"--set", "s." + key, value}};
        apply_overrides({{"s", describe(sample)}}, overrides);
    } catch (const InputError& error) {
        return error.what();
    }
    return "good";
}

TEST(Config, HoldsEveryKindOfValueToItsTypeAndBounds) {
    Sample sample;
    EXPECT_EQ(set(sample, "count", "0"), "--set: /s/count: 0 is not between 1 and 9");
    EXPECT_EQ(set(sample, "count", "2.5"), "--set: /s/count: 2.5 is not a whole number");
    EXPECT_EQ(set(sample, "count", "99999999999"), "--set: /s/count: 99999999999 is not between 1 and 9");
    EXPECT_EQ(set(sample, "count", "9"), "good");
    EXPECT_EQ(sample.count, 9);
    EXPECT_EQ(set(sample, "size_mm", "1.5"), "--set: /s/size_mm: 1.5 is not at least 2");
    EXPECT_EQ(set(sample, "size_mm", "2"), "good");
    EXPECT_EQ(sample.size_mm, 2.0);
    EXPECT_EQ(set(sample, "size_mm", "null"), "good");
    EXPECT_FALSE(sample.size_mm.has_value());
    EXPECT_EQ(set(sample, "list", "[0.5, 0]"), "--set: /s/list: value 1: 0 is not above 0 and at most 1");
    EXPECT_EQ(set(sample, "list", "[0.5, true]"), "--set: /s/list: value 1: true is not a number");
    EXPECT_EQ(set(sample, "list", "3"), "--set: /s/list: 3 is not a list of numbers");
    EXPECT_TRUE(sample.list.empty());
    EXPECT_EQ(set(sample, "flag", "yes"), "--set: /s/flag: \"yes\" is neither true nor false");
}

TEST(Config, TableNamesKeyUnitDefaultValuesAndMeaning) {
    const std::string table = options_table("place");
    EXPECT_THAT(table, HasSubstr("place.chord_tolerance_mm"));
    EXPECT_THAT(table, testing::Not(HasSubstr("plan.")));
    EXPECT_THAT(options_table("plan"), testing::ContainsRegex("plan.speed_mm_s +mm/s +8.0 "));
    EXPECT_THAT(options_table(), HasSubstr("export.base_from_scan"));
    EXPECT_THROW(options_table("plna"), InputError);
}

TEST(Config, SchemaListsEveryOptionOfTheResolvedConfig) {
    const auto schema = nlohmann::json::parse(config_schema());
    const auto config = nlohmann::json::parse(config_json(Config()));
    for (const auto& [stage, options] : config.items()) {
        for (const auto& [key, value] : options.items()) {
            const auto& property = schema.at("properties").at(stage).at("properties").at(key);
            EXPECT_EQ(property.at("default"), value) << stage << "/" << key;
            EXPECT_FALSE(property.at("description").get<std::string>().empty()) << stage << "/" << key;
        }
        EXPECT_EQ(schema.at("properties").at(stage).at("additionalProperties"), false);
    }
}

TEST(Config, FileMustBeThereRegularAndOfReasonableSize) {
    EXPECT_THROW(read_config("/no/such/config.json"), InputError);
    EXPECT_THROW(read_config("/tmp"), InputError);
    EXPECT_THROW(read_config("/dev/zero"), InputError);
}

}  // namespace config_test
}  // namespace seampath
