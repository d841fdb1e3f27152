#include "pipeline/stored_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/run.hpp"
#include "stages/error.hpp"
#include "tests/pipeline/run_support.hpp"

namespace seampath {
namespace stored_run_test {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::ThrowsMessage;

void rewrite(const fs::path& file, const std::string& from, const std::string& to) {
    std::string text = text_of(file);
    ASSERT_NE(text.find(from), std::string::npos);
    text.replace(text.find(from), from.size(), to);
    std::ofstream(file, std::ios::binary) << text;
}

TEST(StoredRun, GivesBackWhatTheRunTookAndFound) {
    const TestFolder folder;
    write_small_tee(folder.path() / "scans");
    const fs::path scan = folder.path() / "scans" / "scan.ply", out = folder.path() / "out";
    Config config;
    config.validate.tolerance_mm = kLooseToleranceMm;
    const PartResult part = run_part(scan, out, config);
    const StoredRun run = load_run(out, {});
    EXPECT_EQ(config_json(run.config), config_json(config));
    EXPECT_EQ(run.scan.points, part.scan.points);
    ASSERT_EQ(run.seams.size(), part.extraction.seams.size());
    ASSERT_FALSE(run.seams.empty());
    EXPECT_EQ(run.seams[0].points.back().p, part.extraction.seams[0].points.back().p);

    fs::rename(folder.path() / "scans", folder.path() / "moved");
    EXPECT_THAT([&] { load_run(out, {}); },
                ThrowsMessage<InputError>(HasSubstr("any more; say where it is with --scan")));
    EXPECT_EQ(load_run(out, folder.path() / "moved" / "scan.ply").scan.points, part.scan.points);
    EXPECT_THAT([&] { load_run(out, folder.path() / "moved" / "truth.json"); },
                ThrowsMessage<InputError>(HasSubstr("is not the scan of")));

    fs::rename(folder.path() / "moved", folder.path() / "scans");
    rewrite(out / "2-seams.json", "\"confidence\"", "\"confidents\"");
    EXPECT_THAT([&] { load_run(out, {}); }, ThrowsMessage<InputError>(HasSubstr("2-seams.json is no whole artefact")));
    fs::remove(out / "2-seams.json");
    EXPECT_THAT([&] { load_run(out, {}); },
                ThrowsMessage<InputError>(HasSubstr("has no 1-scan.json and 2-seams.json")));
}

// A run can be moved together with its scan.
TEST(StoredRun, FindsAScanThatMovedWithIt) {
    const TestFolder folder;
    write_small_tee(folder.path() / "a" / "scans");
    run_part(folder.path() / "a" / "scans" / "scan.ply", folder.path() / "a" / "out", {});
    fs::rename(folder.path() / "a", folder.path() / "b");
    EXPECT_FALSE(load_run(folder.path() / "b" / "out", {}).seams.empty());
}

}  // namespace stored_run_test
}  // namespace seampath
