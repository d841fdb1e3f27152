#include "datasets/regression/suite.hpp"

#include <algorithm>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/error.hpp"
#include "tests/test_folder.hpp"

namespace seampath {
namespace suite_test {

using testing::AllOf;
using testing::HasSubstr;

/// A suite of these rows, with the keys that every row needs as defaults.
std::string suite_text(const std::string& rows, const std::string& metrics = "{}") {
    return R"({"schema": "seampath suite", "version": 1, "name": "test", "metrics": )" + metrics + R"(,
        "defaults": {"licence": "GPL-3.0-or-later", "origin": "made here", "joint": "fillet", "seeds": 2},
        // rows
        "cases": [)" +
           rows + "]}";
}

Suite suite_of(const std::string& text) {
    const TestFolder folder;
    std::ofstream(folder.path() / "suite.json") << text;
    return read_suite(folder.path());
}

std::string problems_of(const std::string& text) {
    try {
        suite_of(text);
    } catch (const InputError& error) {
        return error.what();
    }
    return "no InputError";
}

TEST(Suite, RowsTakeWhatTheyDoNotSayFromTheDefaults) {
    const Suite suite = suite_of(suite_text(
        R"({"id": "a", "scene": {"kind": "lap", "gap_mm": 0.5}, "unit": "m", "tags": ["x"]}, {"id": "b", "seeds": [7, 3]})"));
    ASSERT_EQ(suite.cases.size(), 2U);
    EXPECT_EQ(suite.cases[0].scene.kind, SceneKind::lap);
    EXPECT_EQ(suite.cases[0].scene.gap_mm, 0.5);
    EXPECT_EQ(suite.cases[0].unit, Unit::m);
    EXPECT_THAT(suite.cases[0].seeds, testing::ElementsAre(1, 2));
    EXPECT_THAT(suite.cases[1].seeds, testing::ElementsAre(7, 3));
    EXPECT_EQ(suite.cases[1].licence, "GPL-3.0-or-later");
    EXPECT_NE(suite.cases[0].sha256, suite.cases[1].sha256);
}

TEST(Suite, ARowOfSeveralPresetsIsACaseEach) {
    const Suite suite = suite_of(suite_text(R"({"id": "a", "presets": ["metrology", "phoxi_s"]})"));
    ASSERT_EQ(suite.cases.size(), 2U);
    EXPECT_EQ(suite.cases[0].id, "a-metrology");
    EXPECT_EQ(suite.cases[0].scanner.sigma_mm, 0.01);
    EXPECT_EQ(suite.cases[1].id, "a-phoxi-s");
    EXPECT_EQ(suite.cases[1].scanner.sigma_mm, 0.03);
}

TEST(Suite, TheFirstBandThatFitsCountsAndThoseOfTheCaseStandFirst) {
    const Suite suite = suite_of(suite_text(R"({"id": "a", "metrics": {"fitted_rms_mm": {"absolute": 3}}})",
                                            R"({"program.*.rms_mm": {"absolute": 1}, "*_rms_mm": {"absolute": 2}})"));
    const SuiteCase& entry = suite.cases.at(0);
    EXPECT_EQ(band_of(entry, "program.abb.rms_mm")->absolute, 1);
    EXPECT_EQ(band_of(entry, "path_rms_mm")->absolute, 2);
    EXPECT_EQ(band_of(entry, "fitted_rms_mm")->absolute, 3);
    EXPECT_EQ(band_of(entry, "rms_mm"), nullptr);
}

TEST(Suite, BandsTagsAndLimitsDoNotChangeWhatACaseIs) {
    const auto sha = [](const std::string& more) {
        return suite_of(suite_text(R"({"id": "a")" + more + "}")).cases.at(0).sha256;
    };
    EXPECT_EQ(sha(""), sha(R"(, "tags": ["x"], "time_s": 3, "memory_mb": 9, "metrics": {"seams": {}})"));
    EXPECT_NE(sha(""), sha(R"(, "config": {"plan": {"speed_mm_s": 6}})"));
    EXPECT_NE(sha(""), sha(R"(, "seeds": 3)"));
}

TEST(Suite, EverythingWrongIsToldAtOnceWithItsPlace) {
    const std::string problems = problems_of(suite_text(
        R"({"id": "A b", "joint": "filet", "scene": {"gap_mm": -1}, "colour": 1, "seeds": [1, 1]},
           {"id": "c", "input": "files", "files": [{"path": "x", "bytes": 3}], "expect": "refused", "truth": "none"},
           {"id": "d", "config": {"plan": {"speed_mm_s": -1}}, "preset": "zivid"}, {"id": "d", "presets": "x"})",
        R"({"seams": {"absolute": -1, "better": "up"}})"));
    for (const char* problem :
         {"suite.json: /cases/0/id: \"A b\" is no name of a case", "/cases/0/joint: \"filet\" is no kind of joint",
          "did you mean \"fillet\"?", "/cases/0/scene/gap_mm: -1 is not at least 0",
          "/cases/0/colour: there is no such key", "/cases/0/seeds: [1,1] are no seeds",
          "/cases/1/files/0: {\"path\":\"x\",\"bytes\":3} needs path, sha256", "/cases/1/reason: is missing",
          "/cases/2: config: /plan/speed_mm_s: -1 is not between 0.1 and 1000",
          "/cases/2/preset: dataset: there is no preset \"zivid\"", "/cases/3/presets: \"x\" is no list of texts",
          "/metrics/seams/absolute: -1 is not at least 0",
          "/metrics/seams/better: \"up\" is none of lower, higher, both"}) {
        EXPECT_THAT(problems, HasSubstr(problem));
    }
}

TEST(Suite, OfAnotherKindOrVersionIsRefused) {
    EXPECT_THAT(problems_of("{}"), HasSubstr("\"seampath suite\" of version 1 was needed"));
    EXPECT_THAT(problems_of("{"), HasSubstr("suite.json: /: parse error at line 1"));
    EXPECT_THAT(problems_of(R"({"schema": "seampath suite", "version": 1, "name": "n", "cases": []})"),
                HasSubstr("/cases: is no list of cases"));
    EXPECT_THAT(problems_of(suite_text(R"({"id": "a"}, {"id": "a"})")), HasSubstr("/cases/1/id: \"a\" stands twice"));
}

/// What the project ships can be read, and says of every case where it is from.
TEST(Suite, ThoseOfTheProjectAreWhole) {
    std::size_t suites = 0;
    for (const auto& entry :
         std::filesystem::directory_iterator(std::filesystem::path(SEAMPATH_SOURCE_DIR) / "datasets" / "suites")) {
        const Suite suite = read_suite(entry.path());
        EXPECT_EQ(suite.name, entry.path().filename());
        ++suites;
    }
    EXPECT_GE(suites, 1U);
}

}  // namespace suite_test
}  // namespace seampath
