#include "pipeline/run.hpp"

#include <fstream>
#include <map>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/dataset.hpp"
#include "pipeline/files.hpp"
#include "stages/error.hpp"
#include "tests/pipeline/run_support.hpp"

namespace seampath {
namespace run_test {

namespace fs = std::filesystem;
using Stages = std::vector<std::string>;

/// A short tee, coarse enough for many runs; made once.
const fs::path& tee_scan() {
    static const TestFolder folder;
    static const fs::path scan = [] {
        write_small_tee(folder.path());
        return folder.path() / "scan.ply";
    }();
    return scan;
}

Config loose_config() {
    Config config;
    config.validate.tolerance_mm = kLooseToleranceMm;
    return config;
}

Stages resumed_stages(const PartResult& part) {
    Stages stages;
    for (const auto& timing : part.timings) {
        if (timing.resumed) {
            stages.push_back(timing.stage);
        }
    }
    return stages;
}

TEST(Run, WritesEveryFileOfTheContract) {
    const TestFolder out;
    const PartResult part = run_part(tee_scan(), out.path(), loose_config());
    ASSERT_FALSE(part.models.empty());
    EXPECT_TRUE(part.pass());
    const auto files = contents(out.path());
    for (const auto* name :
         {"config.resolved.json", "1-scan.json", "2-seams.json", "3-nodes.json", "4-models.json", "5-deviation.json",
          "6-plan.json", "seam_points.csv", "waypoints.csv", "seams.json", "report.json", "report.html"}) {
        EXPECT_TRUE(files.contains(name)) << name;
    }
    for (const std::string robot : {"csv", "json", "abb", "ur"}) {
        EXPECT_TRUE(files.contains("programs/" + robot + "/manifest.json")) << robot;
    }
    EXPECT_TRUE(
        files.at("seam_points.csv").starts_with("seam,index,station_mm,x,y,z,n1x,n1y,n1z,n2x,n2y,n2z,sigma_mm\n"));
    EXPECT_THAT(files.at("waypoints.csv"),
                testing::HasSubstr("\nseam,index,kind,station_mm,x,y,z,qw,qx,qy,qz,speed_mm_s,time_s,sigma_mm\n"));
}

TEST(Run, SameRunTwiceGivesSameBytes) {
    const TestFolder first;
    const TestFolder second;
    run_part(tee_scan(), first.path(), loose_config());
    run_part(tee_scan(), second.path(), loose_config());
    expect_same_files(first.path(), second.path());
}

TEST(Run, UnchangedIsTakenOverFromArtefacts) {
    const TestFolder out;
    run_part(tee_scan(), out.path(), loose_config());
    const auto before = contents(out.path());
    const PartResult again = run_part(tee_scan(), out.path(), loose_config());
    EXPECT_EQ(resumed_stages(again), (Stages{"extract", "place", "fit", "validate", "plan"}));
    EXPECT_EQ(contents(out.path()), before);
}

TEST(Run, ChangedOptionRecomputesThatStageAndThoseAfterIt) {
    const TestFolder out;
    Config config = loose_config();
    run_part(tee_scan(), out.path(), config);
    config.plan.speed_mm_s = 5;
    EXPECT_EQ(resumed_stages(run_part(tee_scan(), out.path(), config)),
              (Stages{"extract", "place", "fit", "validate"}));
    config.place.chord_tolerance_mm = 0.04;
    EXPECT_EQ(resumed_stages(run_part(tee_scan(), out.path(), config)), (Stages{"extract"}));
    config.read.mesh_spacing_mm = 0.3;
    EXPECT_EQ(resumed_stages(run_part(tee_scan(), out.path(), config)), Stages{});
    const TestFolder fresh;
    run_part(tee_scan(), fresh.path(), config);
    expect_same_files(out.path(), fresh.path());
}

TEST(Run, ChangedScanRecomputesEverything) {
    const TestFolder out;
    const TestFolder other;
    const fs::path scan = other.path() / "scan.ply";
    fs::copy_file(tee_scan(), scan);
    run_part(scan, out.path(), loose_config());
    std::fstream file(scan, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(-1, std::ios::end);
    const char byte = static_cast<char>(file.peek() ^ 1);
    file.seekp(-1, std::ios::end);
    file.write(&byte, 1);
    file.close();
    EXPECT_EQ(resumed_stages(run_part(scan, out.path(), loose_config())), Stages{});
}

TEST(Run, FromRecomputesThatStageOn) {
    const TestFolder out;
    run_part(tee_scan(), out.path(), loose_config());
    EXPECT_EQ(resumed_stages(run_part(tee_scan(), out.path(), loose_config(), {3})), (Stages{"extract", "place"}));
    EXPECT_EQ(resumed_stages(run_part(tee_scan(), out.path(), loose_config(), {0})), Stages{});
}

TEST(Run, DamagedArtefactIsRecomputed) {
    const TestFolder out;
    run_part(tee_scan(), out.path(), loose_config());
    const auto before = contents(out.path());
    std::ofstream(out.path() / "4-models.json") << before.at("4-models.json").substr(0, 300);
    EXPECT_EQ(resumed_stages(run_part(tee_scan(), out.path(), loose_config())),
              (Stages{"extract", "place", "validate", "plan"}));
    EXPECT_EQ(contents(out.path()), before);
}

TEST(Run, ProgramsOfAnEarlierConfigDoNotStayBesideAFailedSeam) {
    const TestFolder out;
    Config config = loose_config();
    run_part(tee_scan(), out.path(), config);
    ASSERT_TRUE(fs::exists(out.path() / "programs" / "abb"));
    config.validate.tolerance_mm = 1e-6;
    const PartResult failed = run_part(tee_scan(), out.path(), config);
    EXPECT_FALSE(failed.pass());
    EXPECT_FALSE(fs::exists(out.path() / "programs" / "abb"));
    config.export_.even_if_out_of_tolerance = true;
    run_part(tee_scan(), out.path(), config);
    EXPECT_TRUE(fs::exists(out.path() / "programs" / "abb"));
}

TEST(Run, StopsBetweenStagesAndGoesOnFromThere) {
    const TestFolder undisturbed;
    run_part(tee_scan(), undisturbed.path(), loose_config());
    const TestFolder out;
    int stops = 0;
    for (bool finished = false; !finished && stops < 1000;) {
        int asked = 0;
        Progress progress;
        progress.stop = [&] { return asked++ >= stops; };
        try {
            run_part(tee_scan(), out.path(), loose_config(), {}, progress);
            finished = true;
        } catch (const Interrupted&) {
            ++stops;
        }
    }
    EXPECT_GT(stops, 8);
    EXPECT_LT(stops, 1000);
    expect_same_files(out.path(), undisturbed.path());
}

TEST(Run, InMemoryGivesTheSameAsWithAFolder) {
    const TestFolder out;
    const PartResult with_folder = run_part(tee_scan(), out.path(), loose_config());
    const PartResult in_memory = run_part(read(tee_scan(), ReadOptions()), loose_config());
    ASSERT_EQ(in_memory.plan.waypoints.size(), with_folder.plan.waypoints.size());
    for (std::size_t i = 0; i < in_memory.plan.waypoints.size(); ++i) {
        EXPECT_EQ(in_memory.plan.waypoints[i].p, with_folder.plan.waypoints[i].p);
    }
}

TEST(RunFolder, RefusesASecondRunAtTheSameTime) {
    const TestFolder out;
    const RunFolder first(out.path());
    EXPECT_THROW(RunFolder(out.path()), InputError);
}

TEST(RunFolder, RemovesTemporaryFilesOfAKilledRunAndNothingElse) {
    const TestFolder out;
    fs::create_directories(out.path() / "programs" / "abb");
    for (const auto* name : {"report.json.tmp.4711", "programs/abb/a.mod.tmp.12", "mine.tmp.txt", "notes.tmp."}) {
        std::ofstream(out.path() / name) << "x";
    }
    const RunFolder folder(out.path());
    EXPECT_FALSE(fs::exists(out.path() / "report.json.tmp.4711"));
    EXPECT_FALSE(fs::exists(out.path() / "programs/abb/a.mod.tmp.12"));
    EXPECT_TRUE(fs::exists(out.path() / "mine.tmp.txt"));
    EXPECT_TRUE(fs::exists(out.path() / "notes.tmp."));
}

}  // namespace run_test
}  // namespace seampath
