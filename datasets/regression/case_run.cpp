#include "datasets/regression/case_run.hpp"

#include <chrono>

#include <sched.h>
#include <sys/resource.h>

#include "datasets/regression/case_input.hpp"
#include "datasets/regression/thumbnail.hpp"
#include "pipeline/digest.hpp"
#include "pipeline/files.hpp"
#include "pipeline/run.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxProductBytes = std::size_t{1} << 31;

/// Lets this thread, and those that it starts, have so many of the processors until it goes.
class Processors {
public:
    explicit Processors(int count) {
        ensure(sched_getaffinity(0, sizeof before_, &before_) == 0, "the processors of this process are known");
        cpu_set_t few;
        CPU_ZERO(&few);
        for (int cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&few) < count; ++cpu) {
            if (CPU_ISSET(cpu, &before_)) {
                CPU_SET(cpu, &few);
            }
        }
        ensure(sched_setaffinity(0, sizeof few, &few) == 0, "a process may give up processors");
    }
    ~Processors() { sched_setaffinity(0, sizeof before_, &before_); }
    Processors(const Processors&) = delete;
    Processors& operator=(const Processors&) = delete;

private:
    cpu_set_t before_;
};

/// Files that two folders do not have alike.
double different_files(const fs::path& a, const fs::path& b) {
    double different = 0;
    for (const auto& entry : fs::recursive_directory_iterator(a)) {
        if (entry.is_regular_file()) {
            const fs::path other = b / entry.path().lexically_relative(a);
            different += !fs::exists(other) || read_file(entry.path(), kMaxProductBytes, "dataset") !=
                                                   read_file(other, kMaxProductBytes, "dataset");
        }
    }
    return different;
}

/// The same on 1 and on 2 processors; `run` is the folder of the run on all of them.
double files_that_differ(const fs::path& scan, const Config& config, const fs::path& folder) {
    double different = 0;
    for (const int count : {1, 2}) {
        const Processors limited(count);
        const fs::path other = folder / ("run-on-" + std::to_string(count));
        run_part(scan, other, config, {0});
        different += different_files(folder / "run", other);
        fs::remove_all(other);
    }
    return different;
}

void measure_cost(const PartResult& part, std::chrono::steady_clock::time_point start, Measurements& to) {
    for (const StageTiming& timing : part.timings) {
        to.add("time_" + timing.stage + "_s", timing.seconds);
    }
    to.add("time_s", std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    rusage used{};
    getrusage(RUSAGE_SELF, &used);
    to.add("memory_mb", static_cast<double>(used.ru_maxrss) / 1024);
}

void run_scan(const SuiteCase& entry, const MadeInput& input, const fs::path& folder, CaseRun& run) {
    const Config config = parse_config(entry.config, "config");
    const auto start = std::chrono::steady_clock::now();
    const PartResult part = run_part(input.file, folder / "run", config, {0});
    run.outcome = part.models.empty() ? "no seam" : "seam";
    RunFolder(folder).write("thumbnail.svg", thumbnail_svg(part));
    measure_run(part, run.measured);
    if (input.truth) {
        measure_truth(part, *input.truth, input.scene ? &*input.scene : nullptr, run.measured);
    }
    measure_cost(part, start, run.measured);
    if (entry.threads) {
        run.measured.add("files_that_differ", files_that_differ(input.file, config, folder));
    }
}

void run_fixture(const MadeInput& input, CaseRun& run) {
    const auto start = std::chrono::steady_clock::now();
    const FixtureCalibration calibration = calibrate_fixture(input.file, input.nominal, {});
    run.outcome = "frame";
    measure_fixture(calibration, input.base_from_part, run.measured);
    measure_cost({}, start, run.measured);
}

}  // namespace

std::string run_key(const SuiteCase& entry, std::uint64_t seed, const std::string& build) {
    std::string made_from = entry.sha256 + "\n" + std::to_string(seed) + "\n" + build;
    for (const CaseFile& file : entry.files) {
        made_from += "\n" + file.sha256;
    }
    return sha256(made_from);
}

std::string data_problem(const SuiteCase& entry) {
    for (const CaseFile& file : entry.files) {
        if (!fs::is_regular_file(file.path)) {
            return "there is no file " + file.path.string();
        }
        if (const auto bytes = fs::file_size(file.path); bytes != file.bytes) {
            return file.path.string() + " has " + std::to_string(bytes) + " bytes; the suite's has " +
                   std::to_string(file.bytes);
        }
        if (const std::string found = sha256_of_file(file.path); found != file.sha256) {
            return "the SHA-256 of " + file.path.string() + " is " + found + "; that of the suite's is " + file.sha256;
        }
    }
    return {};
}

CaseRun run_case(const SuiteCase& entry, std::uint64_t seed, const fs::path& folder) {
    CaseRun run;
    run.id = entry.id;
    run.seed = seed;
    run.key = run_key(entry, seed, build_id());
    try {
        const MadeInput input = make_input(entry, seed, folder / "input");
        if (entry.input == CaseInput::balls) {
            run_fixture(input, run);
        } else {
            run_scan(entry, input, folder, run);
        }
    } catch (const InputError& error) {
        run.outcome = "refused";
        run.message = error.what();
    }
    return run;
}

}  // namespace seampath
