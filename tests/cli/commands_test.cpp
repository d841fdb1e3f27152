#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/spawn.hpp"

namespace seampath {
namespace commands_test {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

TEST(Cli, RunPrintsATableAndWhereTheResultsAre) {
    const TestFolder out;
    const Outcome run = seampath_program(run_small_tee(out.path()));
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_THAT(run.out,
                AllOf(HasSubstr("scan: pass\n"), HasSubstr("fillet"), HasSubstr((out.path() / "report.html").string()),
                      HasSubstr((out.path() / "programs").string())));
    for (const auto* stage : {"read ", "extract ", "place ", "fit ", "validate ", "plan ", "export ", "report "}) {
        EXPECT_THAT(run.err, HasSubstr(stage));
    }
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 8) << "one line a stage\n" << run.err;
}

TEST(Cli, RunWithJsonPrintsTheReport) {
    const TestFolder out;
    const Outcome run = seampath_program(run_small_tee(out.path(), {"--json"}));
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(run.out, text_of(out.path() / "report.json"));
}

TEST(Cli, ResolvedConfigRunsAgainUnchanged) {
    const TestFolder first;
    const TestFolder second;
    const std::string config = first.path() / "config.resolved.json";
    EXPECT_EQ(seampath_program(
                  run_small_tee(first.path(), {"--set", "plan.speed_mm_s=6", "--robot", "ur,csv", "--joint", "fillet"}))
                  .status,
              0);
    EXPECT_THAT(text_of(config),
                AllOf(HasSubstr("\"speed_mm_s\": 6.0"), HasSubstr("\"ur,csv\""), HasSubstr("\"fillet\"")));
    EXPECT_EQ(seampath_program({"run", small_tee(), "--out", second.path(), "--config", config}).status, 0);
    expect_same_files(first.path(), second.path());
    EXPECT_FALSE(fs::exists(first.path() / "programs" / "abb"));
}

TEST(Cli, SecondRunTakesOverWhatFreshAndFromComputeAgain) {
    const TestFolder out;
    const auto resumed = [&](const std::vector<std::string>& more) {
        const std::string err = seampath_program(run_small_tee(out.path(), more)).err;
        int count = 0;
        for (auto at = err.find("(resumed)"); at != std::string::npos; at = err.find("(resumed)", at + 1)) {
            ++count;
        }
        return count;
    };
    EXPECT_EQ(resumed({}), 0);
    EXPECT_EQ(resumed({}), 5);
    EXPECT_EQ(resumed({"--from", "validate"}), 3);
    EXPECT_EQ(resumed({"--from", "export"}), 5);
    EXPECT_EQ(resumed({"--fresh"}), 0);
    const Outcome wrong = seampath_program(run_small_tee(out.path(), {"--from", "validat"}));
    EXPECT_EQ(wrong.status, 2);
    EXPECT_THAT(wrong.err, HasSubstr("did you mean \"validate\"?"));
}

TEST(Cli, SeveralScansGoIntoFoldersOfTheirNamesAndOneFailureStopsNoOther) {
    const TestFolder folder;
    fs::create_directories(folder.path() / "a");
    fs::create_directories(folder.path() / "b");
    fs::copy_file(small_tee(), folder.path() / "a" / "tee.ply");
    fs::copy_file(small_tee(), folder.path() / "b" / "tee.ply");
    const fs::path out = folder.path() / "out";
    const Outcome run =
        seampath_program({"run", folder.path() / "a" / "tee.ply", folder.path() / "gone.ply",
                          folder.path() / "b" / "tee.ply", "--out", out, "--set", "validate.tolerance_mm=3"});
    EXPECT_EQ(run.status, 2);
    EXPECT_THAT(run.err, HasSubstr("gone: read: "));
    EXPECT_TRUE(fs::exists(out / "tee" / "report.html"));
    EXPECT_TRUE(fs::exists(out / "tee-2" / "report.html"));
    const auto summary = nlohmann::json::parse(text_of(out / "summary.json"));
    ASSERT_EQ(summary.at("parts").size(), 3u);
    EXPECT_EQ(summary.at("parts")[0].at("result"), "pass");
    EXPECT_EQ(summary.at("parts")[1].at("exit_status"), 2);
    EXPECT_EQ(summary.at("parts")[2].at("name"), "tee-2");
    const Outcome json = seampath_program({"run", folder.path() / "a" / "tee.ply", folder.path() / "b" / "tee.ply",
                                           "--out", out, "--json", "--set", "validate.tolerance_mm=3"});
    EXPECT_EQ(json.status, 0) << json.err;
    EXPECT_EQ(nlohmann::json::parse(json.out).at("parts").size(), 2u);
}

TEST(Cli, CheckTellsAllProblemsOfAConfig) {
    const TestFolder folder;
    const std::string config = folder.path() / "cell.json";
    std::ofstream(config) << R"({"plan": {"speed_mm_s": -1}, "fit": {"foo": 1}})";
    const Outcome bad = seampath_program({"check", config});
    EXPECT_EQ(bad.status, 2);
    EXPECT_THAT(bad.err, AllOf(HasSubstr(config + ": /plan/speed_mm_s: -1 is not "),
                               HasSubstr(config + ": /fit/foo: there is no such option")));
    std::ofstream(config) << "{} // all defaults";
    const Outcome good = seampath_program({"check", config, small_tee()});
    EXPECT_EQ(good.status, 0) << good.err;
    EXPECT_THAT(good.out, AllOf(HasSubstr(config + ": good"), HasSubstr("points")));
}

TEST(Cli, InfoTellsWhatIsInEveryKindOfFile) {
    const TestFolder out;
    ASSERT_EQ(seampath_program(run_small_tee(out.path())).status, 0);
    EXPECT_THAT(seampath_program({"info", small_tee()}).out,
                AllOf(HasSubstr("what: scan"), HasSubstr("points: "), HasSubstr("size_mm: ")));
    const auto truth =
        nlohmann::json::parse(seampath_program({"info", small_tee().parent_path() / "truth.json", "--json"}).out);
    EXPECT_EQ(truth.at("what"), "truth of a data set");
    EXPECT_NEAR(truth.at("content").at("seams")[0].at("length_mm").get<double>(), 40, 0.2);
    EXPECT_THAT(seampath_program({"info", out.path() / "3-nodes.json"}).out,
                AllOf(HasSubstr("artefact"), HasSubstr("stage: place")));
    EXPECT_THAT(seampath_program({"info", out.path() / "config.resolved.json"}).out, HasSubstr("what: config"));
    EXPECT_THAT(seampath_program({"info", out.path()}).out, HasSubstr("what: report"));
    EXPECT_EQ(seampath_program({"info", out.path() / "none.ply"}).status, 2);
}

TEST(Cli, OptionsPrintsTableAndSchema) {
    EXPECT_THAT(seampath_program({"options", "plan"}).out, HasSubstr("plan.speed_mm_s"));
    EXPECT_EQ(nlohmann::json::parse(seampath_program({"options", "--json-schema"}).out).at("type"), "object");
    EXPECT_EQ(seampath_program({"options", "plna"}).status, 2);
}

TEST(Cli, DatasetMakesTheSameBytesFromTheSameSeed) {
    const TestFolder first;
    const TestFolder second;
    for (const auto* folder : {&first, &second}) {
        const Outcome made = seampath_program({"dataset", "make", "tee", "--preset", "standard", "--seed", "5", "--out",
                                               folder->path(), "--set", "scene.length_mm=40", "--set",
                                               "scanner.pitch_x_mm=1", "--set", "scanner.pitch_y_mm=1"});
        ASSERT_EQ(made.status, 0) << made.err;
    }
    expect_same_files(first.path(), second.path());
    EXPECT_EQ(contents(first.path()).size(), 2u);
    EXPECT_THAT(seampath_program({"dataset", "list"}).out,
                AllOf(HasSubstr("pipe-on-pipe"), HasSubstr("standard"), HasSubstr("scene.lean_deg")));
    EXPECT_THAT(seampath_program({"dataset", "make", "tea", "--out", "x"}).err, HasSubstr("did you mean \"tee\"?"));
    EXPECT_THAT(seampath_program({"dataset", "make", "tee", "--out", "x", "--set", "scene.lengthmm=3"}).err,
                HasSubstr("--set: /scene/lengthmm: there is no such option; did you mean \"length_mm\"?"));
}

TEST(Cli, UnknownCommandsAndFlagsGiveAHintAndStatus2) {
    const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
        {{"rnu"}, "seampath: \"rnu\" is no command; there are run, check, info, options, dataset"},
        {{"dataset", "mak"}, "did you mean \"make\"?"},
        {{"run", "--ot", "x", "a.ply"}, "seampath run: \"--ot\" is no option; did you mean \"--out\"?"},
        {{"run", "a.ply"}, "seampath run: --out is required"},
        {{"run", "--out", "x"}, "seampath run: SCAN is required"},
        {{}, "seampath: A subcommand is required"}};
    for (const auto& [arguments, message] : cases) {
        const Outcome outcome = seampath_program(arguments);
        EXPECT_EQ(outcome.status, 2) << message;
        EXPECT_THAT(outcome.err, HasSubstr(message));
        EXPECT_EQ(outcome.out, "");
    }
}

TEST(Cli, EveryHelpHasThreeWorkedExamples) {
    using Words = std::vector<std::string>;
    for (const Words& command : std::vector<Words>{{"run"},
                                                   {"check"},
                                                   {"info"},
                                                   {"options"},
                                                   {"dataset"},
                                                   {"dataset", "make"},
                                                   {"interpolate"},
                                                   {"parametrize"},
                                                   {"saddle"},
                                                   {"mechanism"},
                                                   {"mechanism", "two-tier"},
                                                   {}}) {
        auto arguments = command;
        arguments.push_back("--help");
        const Outcome help = seampath_program(arguments);
        EXPECT_EQ(help.status, 0);
        const auto examples = help.out.substr(help.out.find("Examples:"));
        int count = 0;
        for (auto at = examples.find("\n  seampath "); at != std::string::npos;
             at = examples.find("\n  seampath ", at + 1)) {
            ++count;
        }
        EXPECT_EQ(count, 3) << help.out;
    }
}

TEST(Cli, VersionIsThatOfTheProject) {
    const Outcome version = seampath_program({"--version"});
    EXPECT_EQ(version.status, 0);
    const std::string number = version.out.substr(9, version.out.size() - 10);
    EXPECT_THAT(text_of(fs::path(SEAMPATH_SOURCE_DIR) / "CMakeLists.txt"),
                HasSubstr("project(seampath VERSION " + number + " "));
}

}  // namespace commands_test
}  // namespace seampath
