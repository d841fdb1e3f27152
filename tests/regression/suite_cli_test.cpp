#include <fstream>
#include <regex>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pipeline/digest.hpp"
#include "tests/cli/spawn.hpp"

/// `seampath dataset run | accept | compare | history` on suites of one or two small parts.
namespace seampath {
namespace suite_cli_test {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kLap =
    R"({"id": "lap", "joint": "lap", "seeds": 1, "scene": {"kind": "lap", "length_mm": 40, "margin_mm": 18,
        "overlap_mm": 12, "plate_thickness_mm": 6, "thickness_mm": 3}})";

/// A suite in a folder of its own, and where its runs go.
class SuiteFolder {
public:
    explicit SuiteFolder(const std::string& rows) { write(rows); }

    void write(const std::string& rows) const {
        fs::create_directories(suite());
        std::ofstream(suite() / "suite.json") << R"({"schema": "seampath suite", "version": 1, "name": "test",
            "defaults": {"licence": "none", "origin": "made here", "scanner": {"views": 3, "pitch_x_mm": 0.5,
            "pitch_y_mm": 0.5}},
            "metrics": {"fitted_rms_mm": {"absolute": 0.002}, "points": {"better": "both"},
            "program.*.sha256": {"severity": "note"}}, "cases": [)" +
                                                     rows + "]}";
    }

    fs::path suite() const { return folder_.path() / "suite"; }
    fs::path out() const { return folder_.path() / "out"; }

    Outcome run(std::vector<std::string> more = {}) const {
        std::vector<std::string> words{"dataset", "run", suite(), "--out", out(), "--commit", "here"};
        words.insert(words.end(), more.begin(), more.end());
        return seampath_program(words);
    }

    Outcome accept(std::vector<std::string> more = {}) const {
        std::vector<std::string> words{"dataset", "accept", out()};
        words.insert(words.end(), more.begin(), more.end());
        return seampath_program(words);
    }

    /// Puts a number in the place of the golden one of the first seed.
    void set_golden(const std::string& id, const std::string& metric, double value) const {
        const fs::path file = suite() / id / "baseline.json";
        Json json = Json::parse(text_of(file));
        json["seeds"][0]["metrics"][metric] = value;
        std::ofstream(file) << json.dump();
    }

    double golden(const std::string& id, const std::string& metric) const {
        return Json::parse(text_of(suite() / id / "baseline.json"))["seeds"][0]["metrics"][metric].get<double>();
    }

private:
    TestFolder folder_;
};

TEST(SuiteCommand, FirstNoBaselineThenPassThenRegressionOrStale) {
    const SuiteFolder folder(kLap);
    const Outcome first = folder.run();
    EXPECT_EQ(first.status, 5) << first.err;
    EXPECT_THAT(first.out, HasSubstr("there is no baseline"));
    EXPECT_EQ(folder.accept().status, 2) << "a reason is needed";
    const Outcome accepted = folder.accept({"--reason", "first look"});
    EXPECT_EQ(accepted.status, 0) << accepted.err;
    EXPECT_THAT(accepted.out, HasSubstr("1 baselines written, 1 of them new: first look"));

    const Outcome pass = folder.run();
    EXPECT_EQ(pass.status, 0) << pass.err << pass.out;
    for (const char* file : {"results.json", "junit.xml", "index.html", "history.db", "cases/lap/1/run/report.html"}) {
        EXPECT_TRUE(fs::exists(folder.out() / file)) << file;
    }
    EXPECT_THAT(text_of(folder.out() / "junit.xml"), HasSubstr("tests=\"1\" failures=\"0\" errors=\"0\""));
    EXPECT_THAT(text_of(folder.out() / "index.html"),
                AllOf(HasSubstr("1 of 1 cases pass"), HasSubstr("href=\"cases/lap/1/run/report.html\"")));

    const double rms = folder.golden("lap", "fitted_rms_mm");
    folder.set_golden("lap", "fitted_rms_mm", rms - 0.0021);
    const Outcome worse = folder.run();
    EXPECT_EQ(worse.status, 1) << worse.out;
    EXPECT_THAT(worse.out, HasSubstr("lap: fitted_rms_mm"));
    EXPECT_THAT(text_of(folder.out() / "junit.xml"), HasSubstr("<failure message=\"regression\">fitted_rms_mm"));

    folder.set_golden("lap", "fitted_rms_mm", rms + 0.0021);
    const Outcome better = folder.run({"--resume"});
    EXPECT_EQ(better.status, 0) << better.out;
    EXPECT_THAT(better.out, HasSubstr("stale baseline: fitted_rms_mm"));
    EXPECT_THAT(better.err, HasSubstr("lap seed 1: seam (resumed)"));

    const Outcome again = folder.accept({"--reason", "as it was"});
    EXPECT_THAT(again.out, AllOf(HasSubstr("-0.00210"), HasSubstr("0 of them new")));
    EXPECT_EQ(folder.golden("lap", "fitted_rms_mm"), rms);

    const Outcome history =
        seampath_program({"dataset", "history", folder.out() / "history.db", "--suite", "test", "--case", "lap"});
    EXPECT_EQ(history.status, 0) << history.err;
    EXPECT_THAT(history.out, AllOf(HasSubstr("no baseline"), HasSubstr("regression"), HasSubstr("stale baseline")));
}

TEST(SuiteCommand, BadInputIs2AndNothingIsRun) {
    const SuiteFolder folder(kLap);
    for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
             {"--shard", "0/2"}, {"--shard", "3/2"}, {"--shard", "1/-2"}, {"--filter", "nothing"}, {"--jobs", "0"}}) {
        const Outcome run = folder.run(words);
        EXPECT_EQ(run.status, 2) << words[0] << " " << words[1];
        EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    }
    folder.write(R"({"id": "lap", "joint": "lapp", "seeds": 1})");
    EXPECT_EQ(folder.run().status, 2);
    EXPECT_EQ(seampath_program({"dataset", "run", "nowhere", "--out", folder.out()}).status, 2);
    EXPECT_EQ(seampath_program({"dataset", "compare", folder.out(), folder.out()}).status, 2);
    EXPECT_FALSE(fs::exists(folder.out()));
}

std::string file_row(const std::string& content, std::size_t bytes) {
    return R"({"id": "file", "input": "files", "joint": "none", "truth": "none", "expect": "refused",
        "reason": "does not end", "files": [{"path": "file/scan.ply", "sha256": ")" +
           sha256(content) + R"(", "bytes": )" + std::to_string(bytes) + "}]}";
}

TEST(SuiteCommand, DataThatIsMissingOrAnotherIs3) {
    const std::string content = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n";
    const SuiteFolder folder(file_row(content, content.size()));
    const Outcome missing = folder.run();
    EXPECT_EQ(missing.status, 3);
    EXPECT_THAT(missing.out, HasSubstr("there is no file"));
    fs::create_directories(folder.suite() / "file");
    const fs::path file = folder.suite() / "file" / "scan.ply";
    std::ofstream(file) << content;
    const Outcome refused = folder.run();
    EXPECT_EQ(refused.status, 0) << refused.out << "a refusal that was expected passes";
    std::ofstream(file) << "PLY" + content.substr(3);
    const Outcome other = folder.run();
    EXPECT_EQ(other.status, 3);
    EXPECT_THAT(other.out, HasSubstr("the SHA-256 of"));
    std::ofstream(file) << content + " ";
    EXPECT_THAT(folder.run().out, HasSubstr("the suite's has " + std::to_string(content.size())));
}

/// The process of the case that works below a folder; 0 where there is none.
pid_t case_process(const fs::path& below) {
    for (const auto& entry : fs::directory_iterator("/proc")) {
        const std::string name = entry.path().filename();
        if (name.find_first_not_of("0123456789") != std::string::npos) {
            continue;
        }
        const std::string words = text_of(entry.path() / "cmdline");
        if (words.find(std::string("dataset\0case", 12)) != std::string::npos &&
            words.find(below.string()) != std::string::npos) {
            return static_cast<pid_t>(std::stol(name));
        }
    }
    return 0;
}

TEST(SuiteCommand, ACrashCostsOneCaseOnly) {
    const std::string other = std::regex_replace(kLap, std::regex("\"lap\", \"joint\""), "\"other\", \"joint\"");
    const SuiteFolder folder(std::string(kLap) + "," + other);
    Process suite({"dataset", "run", folder.suite(), "--out", folder.out(), "--jobs", "1"});
    pid_t victim = 0;
    for (int i = 0; i < 2000 && !victim; ++i) {
        victim = case_process(folder.out() / "cases" / "lap");
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    ASSERT_GT(victim, 0);
    kill(victim, SIGSEGV);
    const Outcome outcome = suite.wait();
    EXPECT_EQ(outcome.status, 4) << outcome.err;
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("lap: seed 1: ended by a signal: Segmentation fault"),
                                   HasSubstr("other: there is no baseline")));
    EXPECT_EQ(folder.accept({"--reason", "x"}).status, 2) << "what crashed is no baseline";
    EXPECT_EQ(folder.accept({"--reason", "x", "--filter", "other"}).status, 0);
}

TEST(SuiteCommand, TooMuchTimeOrMemoryIs4) {
#if defined(__SANITIZE_ADDRESS__)
    GTEST_SKIP() << "AddressSanitizer takes far more memory than the program";
#endif
    const std::string lap = kLap;
    const std::string rows = lap.substr(0, lap.size() - 1) + R"(, "time_s": 0.02})";
    const SuiteFolder slow(rows);
    const Outcome late = slow.run();
    EXPECT_EQ(late.status, 4);
    EXPECT_THAT(late.out, HasSubstr("took longer than the 0.02 s"));
    const SuiteFolder large(lap.substr(0, lap.size() - 1) + R"(, "memory_mb": 6})");
    const Outcome full = large.run();
    EXPECT_EQ(full.status, 4);
    EXPECT_THAT(full.out, HasSubstr("needed more than the 6 MB"));
}

TEST(SuiteCommand, ShardsAndFiltersShareTheCasesOut) {
    const std::string content = "ply\n";
    std::string rows;
    for (const std::string id : {"a", "b", "c"}) {
        rows +=
            (rows.empty() ? "" : ",") + std::regex_replace(file_row(content, 4), std::regex("\"file\""),
                                                           "\"" + id + "\", \"tags\": [\"all\", \"tag-" + id + "\"]");
    }
    const SuiteFolder folder(rows);
    fs::create_directories(folder.suite() / "file");
    std::ofstream(folder.suite() / "file" / "scan.ply") << content;
    const auto cases = [&](std::vector<std::string> words) {
        words.push_back("--json");
        std::string ids;
        const Json results = Json::parse(folder.run(words).out);
        for (const Json& one : results.at("cases")) {
            ids += one.at("case").get<std::string>();
        }
        return ids;
    };
    EXPECT_EQ(cases({"--shard", "1/2"}), "ac");
    EXPECT_EQ(cases({"--shard", "2/2"}), "b");
    EXPECT_EQ(cases({"--filter", "tag-b", "--filter", "c"}), "bc");
    EXPECT_EQ(cases({"--filter", "all"}), "abc");
}

}  // namespace suite_cli_test
}  // namespace seampath
