#include <fstream>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mount.h>

#include "tests/cli/spawn.hpp"

namespace seampath {
namespace faults_test {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A run that must end with status 2 and one clear line, and leave no result and nothing half written.
void expect_refused(const std::string& name, const std::string& content, const std::string& message) {
    SCOPED_TRACE(name);
    const TestFolder folder;
    const fs::path scan = folder.path() / name;
    std::ofstream(scan, std::ios::binary) << content;
    const Outcome run = seampath_program({"run", scan, "--out", folder.path() / "out"});
    EXPECT_EQ(run.status, 2) << run.err;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr("read: "));
    EXPECT_THAT(run.err, HasSubstr(message));
    EXPECT_EQ(run.out, "");
    EXPECT_TRUE(!fs::exists(folder.path() / "out") || contents(folder.path() / "out").empty());
}

TEST(Faults, BadScansAreRefusedWithOneLine) {
    const std::string whole = text_of(small_tee());
    expect_refused("empty.ply", "", "empty.ply");
    expect_refused("truncated.ply", whole.substr(0, whole.size() / 2), "truncated.ply");
    expect_refused("text.ply", "this is no scan\n", "text.ply");
    expect_refused("hostile.ply",
                   "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000000000000\nproperty float x\n"
                   "property float y\nproperty float z\nend_header\nabc",
                   "hostile.ply");
}

TEST(Faults, MissingScanAndFolderAsScan) {
    const TestFolder folder;
    const Outcome missing = seampath_program({"run", folder.path() / "gone.ply", "--out", folder.path() / "out"});
    EXPECT_EQ(missing.status, 2);
    EXPECT_THAT(missing.err, HasSubstr("gone.ply"));
    EXPECT_EQ(seampath_program({"run", folder.path(), "--out", folder.path() / "out"}).status, 2);
    EXPECT_EQ(seampath_program({"run", "/dev/zero", "--out", folder.path() / "out"}).status, 2);
}

TEST(Faults, NoSeamIsAResultWithStatus1AndAReport) {
    const TestFolder folder;
    const fs::path scan = folder.path() / "plane.xyz";
    std::ofstream points(scan);
    for (int i = 0; i < 100; ++i) {
        for (int j = 0; j < 100; ++j) {
            points << i * 0.5 << " " << j * 0.5 << " " << ((i * 7919 + j * 104729) % 101) * 0.0005 << "\n";
        }
    }
    points.close();
    const fs::path out = folder.path() / "out";
    const Outcome run = seampath_program({"run", scan, "--out", out});
    EXPECT_EQ(run.status, 1) << run.err;
    EXPECT_THAT(run.out, HasSubstr("plane: no seam found"));
    EXPECT_TRUE(fs::exists(out / "report.html"));
    EXPECT_FALSE(fs::exists(out / "programs" / "abb"));
}

TEST(Faults, OutOfToleranceIsStatus1WithoutPrograms) {
    const TestFolder out;
    const Outcome run =
        seampath_program({"run", small_tee(), "--out", out.path(), "--set", "validate.tolerance_mm=0.000001"});
    EXPECT_EQ(run.status, 1) << run.err;
    EXPECT_THAT(run.out, HasSubstr("scan: out of tolerance"));
    EXPECT_THAT(run.out, HasSubstr("programs  none: no seam may be welded"));
    EXPECT_FALSE(fs::exists(out.path() / "programs" / "abb"));
}

TEST(Faults, NoRoomForTheTorchIsSaidToBeThat) {
    const TestFolder out;
    const Outcome run = seampath_program({"run", small_tee(), "--out", out.path(), "--set", "plan.nozzle_tip_mm=60",
                                          "--set", "plan.nozzle_base_mm=80", "--set", "plan.stick_out_mm=2"});
    EXPECT_EQ(run.status, 1) << run.err;
    EXPECT_THAT(run.out, HasSubstr("programs  none: no room for the torch"));
    EXPECT_FALSE(fs::exists(out.path() / "programs" / "abb"));
}

TEST(Faults, ConfigProblemsComeAllAtOnceBeforeAnyWork) {
    const TestFolder folder;
    const Outcome run = seampath_program({"run", small_tee(), "--out", folder.path() / "out", "--robot", "kuba",
                                          "--set", "plan.speed_mm_s=-1", "--set", "fit.foo=1"});
    EXPECT_EQ(run.status, 2);
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 3) << run.err;
    EXPECT_THAT(run.err, HasSubstr("--robot: /export/robots: \"kuba\" is no known robot; one of csv, json, abb,"));
    EXPECT_FALSE(fs::exists(folder.path() / "out"));
}

TEST(Faults, FolderThatCannotBeWritten) {
    const TestFolder folder;
    std::ofstream(folder.path() / "file") << "x";
    const Outcome under_file = seampath_program({"run", small_tee(), "--out", folder.path() / "file" / "out"});
    EXPECT_EQ(under_file.status, 2);
    EXPECT_EQ(under_file.err.substr(0, 21), "output: cannot write ");
    EXPECT_THAT(under_file.err, HasSubstr("choose another --out"));
    const Outcome proc = seampath_program({"run", small_tee(), "--out", "/proc/self"});
    EXPECT_EQ(proc.status, 2);
    EXPECT_THAT(proc.err, HasSubstr("output: cannot write "));
}

/// Every limit on the size of a file: whatever file fails, one line, status 2, no temporary file; then a run completes.
TEST(Faults, FileThatCannotGrowLeavesNothingHalfWritten) {
    const TestFolder undisturbed;
    ASSERT_EQ(seampath_program(run_small_tee(undisturbed.path())).status, 0);
    const TestFolder out;
    for (rlim_t bytes = 100; bytes < 100'000'000; bytes *= 3) {
        const Outcome run = seampath_program(run_small_tee(out.path()), [bytes] {
            const rlimit limit{bytes, bytes};
            setrlimit(RLIMIT_FSIZE, &limit);
        });
        EXPECT_FALSE(holds_temporary_files(out.path()));
        if (run.status == 0) {
            break;
        }
        EXPECT_EQ(run.status, 2) << run.err;
    }
    expect_same_files(out.path(), undisturbed.path());
}

TEST(Faults, FullDisk) {
    const TestFolder folder;
    const fs::path disk = folder.path() / "disk";
    fs::create_directories(disk);
    if (mount("none", disk.c_str(), "tmpfs", 0, "size=64k") != 0) {
        GTEST_SKIP() << "a full disk needs the right to mount; the limit on file size above is tested in any case";
    }
    const Outcome run = seampath_program({"run", small_tee(), "--out", disk / "out"});
    EXPECT_EQ(run.status, 2) << run.err;
    EXPECT_THAT(run.err, HasSubstr("No space left on device"));
    EXPECT_FALSE(holds_temporary_files(disk));
    umount(disk.c_str());
}

TEST(Faults, StdoutThatIsFull) {
    const Outcome options = seampath_program({"options"}, [] { dup2(open("/dev/full", O_WRONLY), STDOUT_FILENO); });
    EXPECT_EQ(options.status, 2);
    EXPECT_THAT(options.err, HasSubstr("cannot write the result to stdout"));
}

TEST(Faults, TooLittleMemoryIsBadInputNotACrash) {
#if defined(__SANITIZE_ADDRESS__)
    GTEST_SKIP() << "AddressSanitizer needs terabytes of addresses and ends a program that runs out of memory itself";
#endif
    const TestFolder folder;
    const std::string scan = folder.path() / "large.ply";
    std::ofstream(scan)
        << "ply\nformat binary_little_endian 1.0\nelement vertex 50000000\nproperty float x\nproperty float y\n"
           "property float z\nend_header\n";
    fs::resize_file(scan, fs::file_size(scan) + 600'000'000);  // a hole: no space is taken
    const Outcome run = seampath_program({"run", scan, "--out", folder.path() / "out"}, [] {
        const rlimit limit{400'000'000, 400'000'000};
        setrlimit(RLIMIT_AS, &limit);
    });
    EXPECT_EQ(run.status, 2) << run.err;
    EXPECT_THAT(run.err, testing::AnyOf(HasSubstr("memory"), HasSubstr("large.ply")));
}

TEST(Faults, CtrlCEndsWith130AndARunGoesOnFromThere) {
    const TestFolder undisturbed;
    ASSERT_EQ(seampath_program(run_small_tee(undisturbed.path())).status, 0);
    for (const int number : {SIGINT, SIGTERM}) {
        const TestFolder out;
        Process run(run_small_tee(out.path()));
        ASSERT_TRUE(run.wait_for_err("read "));
        run.signal(number);
        const Outcome stopped = run.wait();
        EXPECT_EQ(stopped.status, 130) << stopped.err;
        EXPECT_THAT(stopped.err, HasSubstr("interrupted: finishing the stage at work; Ctrl-C again ends at once"));
        EXPECT_THAT(stopped.err, HasSubstr("interrupted; run the same command again"));
        EXPECT_FALSE(holds_temporary_files(out.path()));
        EXPECT_FALSE(fs::exists(out.path() / "report.html"));
        EXPECT_EQ(seampath_program(run_small_tee(out.path())).status, 0);
        expect_same_files(out.path(), undisturbed.path());
    }
}

TEST(Faults, KilledAtAnyMomentARunFinishesFromItsLastGoodArtefact) {
    const TestFolder undisturbed;
    const auto start = std::chrono::steady_clock::now();
    ASSERT_EQ(seampath_program(run_small_tee(undisturbed.path())).status, 0);
    const auto whole = std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start);
    std::mt19937 random(7);
    for (int round = 0; round < 8; ++round) {
        const TestFolder out;
        for (int kills = 0; kills < 3; ++kills) {
            Process run(run_small_tee(out.path()));
            std::this_thread::sleep_for(std::chrono::microseconds(random() % static_cast<unsigned>(whole.count())));
            run.signal(SIGKILL);
            run.wait();
        }
        const Outcome last = seampath_program(run_small_tee(out.path()));
        ASSERT_EQ(last.status, 0) << last.err;
        expect_same_files(out.path(), undisturbed.path());
    }
}

}  // namespace faults_test
}  // namespace seampath
