// From a scan file to the fitted seam, in time and memory, beside PCL reading the same file. Makes its scans of a pipe
// on a pipe itself. With --check the exit status is 1 when a target is missed.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <pcl/io/ply_io.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "datasets/dataset.hpp"
#include "stages/extract/extract.hpp"
#include "stages/fit/fit.hpp"
#include "stages/place/place.hpp"
#include "stages/read/read.hpp"

namespace {

namespace fs = std::filesystem;
using namespace seampath;

constexpr std::size_t kFew = 2'000'000, kMany = 5'000'000;  // points: up to, and from
constexpr double kMostSecondsOfFew = 2.5;
constexpr double kMostRatioOfMany = 6;  // of the whole way to PCL's reading alone
constexpr double kMostBytesOfMany = 60;
constexpr double kMostGrowth = 1;  // exponent of the time over the points

struct Asked {
    std::vector<std::size_t> points{1'000'000, 1'300'000, 10'000'000};
    int repeats = 5;
    bool check = false;
};

/// What one run took; times are wall clock.
struct Run {
    std::size_t points = 0, seams = 0;
    double read_s = 0, extract_s = 0, fit_s = 0;
    double cpu_s = 0;
    double peak_bytes = 0;  ///< of resident memory
    double total_s() const { return read_s + extract_s + fit_s; }
};

struct Row {
    Run best;
    double pcl_s = 0, peak_bytes = 0;
    double ratio() const { return best.total_s() / pcl_s; }
    double bytes_a_point() const { return peak_bytes / static_cast<double>(best.points); }
};

double now_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Runs `work` in a process of its own, whose memory is that of the work alone.
template <class Work>
Run apart(Work work) {
    int ends[2];
    if (::pipe(ends) != 0) {
        throw std::runtime_error("no pipe");
    }
    const pid_t child = ::fork();
    if (child == 0) {
        int status = 1;
        try {
            const Run run = work();
            status = ::write(ends[1], &run, sizeof run) == sizeof run ? 0 : 1;
        } catch (const std::exception& error) {
            std::cerr << error.what() << "\n";
        }
        std::_Exit(status);
    }
    ::close(ends[1]);
    Run run;
    const bool whole = ::read(ends[0], &run, sizeof run) == sizeof run;
    ::close(ends[0]);
    rusage usage{};
    int status = 0;
    ::wait4(child, &status, 0, &usage);
    if (!whole || status != 0) {
        throw std::runtime_error("a run failed");
    }
    run.cpu_s = static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
                1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
    run.peak_bytes = 1024.0 * static_cast<double>(usage.ru_maxrss);
    return run;
}

/// The scan of preset `standard`, with pixels as large as give that many points.
Run make_scan(const fs::path& folder, std::size_t points) {
    SceneOptions scene;
    scene.kind = SceneKind::pipe_on_pipe;
    const auto with_pitch = [&](double mm) {
        ScannerOptions scanner = preset("standard");
        scanner.pitch_x_mm = scanner.pitch_y_mm = mm;
        return make_dataset(scene, scanner, 1);
    };
    constexpr double kCoarse = 0.64;
    const auto coarse = static_cast<double>(with_pitch(kCoarse).points.size());
    const Dataset dataset = with_pitch(kCoarse * std::sqrt(coarse / static_cast<double>(points)));
    write_dataset(dataset, folder);
    return {};
}

Run load_with_pcl(const fs::path& file) {
    const double start = now_s();
    pcl::PointCloud<pcl::PointXYZ> cloud;
    if (pcl::io::loadPLYFile(file.string(), cloud) < 0) {
        throw std::runtime_error(file.string() + ": PCL cannot read it");
    }
    Run run;
    run.points = cloud.size();
    run.read_s = now_s() - start;
    return run;
}

Run fit_seams(const fs::path& file) {
    Run run;
    const double start = now_s();
    const Scan scan = read(file, {});
    const double got = now_s();
    const Extraction extraction = extract(scan, {});
    const double extracted = now_s();
    for (const Seam& seam : extraction.seams) {
        fit(seam, place(seam, {}), {});
    }
    run.fit_s = now_s() - extracted;
    run.extract_s = extracted - got;
    run.read_s = got - start;
    run.points = scan.points.size();
    run.seams = extraction.seams.size();
    return run;
}

/// Best of several runs, each beside one of PCL's, so that a busy machine slows both; the largest memory.
Row measure(const fs::path& folder, std::size_t points, int repeats) {
    apart([&] { return make_scan(folder, points); });
    const fs::path file = folder / "scan.ply";
    Row row;
    for (int k = 0; k < repeats; ++k) {
        const Run pcl = apart([&] { return load_with_pcl(file); });
        const Run run = apart([&] { return fit_seams(file); });
        if (run.points != pcl.points || run.seams != 1) {
            throw std::runtime_error("PCL reads " + std::to_string(pcl.points) + " points, Seampath " +
                                     std::to_string(run.points) + ", and finds " + std::to_string(run.seams) +
                                     " seams; there is one");
        }
        row.pcl_s = k == 0 ? pcl.read_s : std::min(row.pcl_s, pcl.read_s);
        row.best = k == 0 || run.total_s() < row.best.total_s() ? run : row.best;
        row.peak_bytes = std::max(row.peak_bytes, run.peak_bytes);
    }
    return row;
}

/// 1: twice the points take twice the time.
double growth(const Row& from, const Row& to) {
    return std::log(to.best.total_s() / from.best.total_s()) /
           std::log(static_cast<double>(to.best.points) / static_cast<double>(from.best.points));
}

int missed(const std::vector<Row>& rows) {
    int misses = 0;
    const auto at_most = [&](const char* what, std::size_t points, double value, double limit) {
        if (!(value <= limit)) {
            std::printf("missed: %s at %zu points: %.2f > %g\n", what, points, value, limit);
            ++misses;
        }
    };
    for (const Row& row : rows) {
        if (row.best.points <= kFew) {
            at_most("seconds", row.best.points, row.best.total_s(), kMostSecondsOfFew);
        }
        if (row.best.points >= kMany) {
            at_most("ratio to PCL", row.best.points, row.ratio(), kMostRatioOfMany);
            at_most("bytes a point", row.best.points, row.bytes_a_point(), kMostBytesOfMany);
        }
    }
    if (rows.size() > 1) {
        at_most("growth", rows.back().best.points, growth(rows.front(), rows.back()), kMostGrowth);
    }
    return misses;
}

int run(const Asked& asked) {
    const fs::path folder = fs::temp_directory_path() / ("seampath-bench-" + std::to_string(::getpid()));
    std::printf(
        "  points  PCL load s  read s  extract s  place, fit s  total s  CPU s  total / PCL  peak bytes a point\n");
    std::vector<Row> rows;
    for (const std::size_t points : asked.points) {
        rows.push_back(measure(folder, points, asked.repeats));
        const Row& row = rows.back();
        const Run& best = row.best;
        std::printf("%8zu  %10.3f  %6.3f  %9.3f  %12.3f  %7.3f  %5.2f  %11.2f  %18.1f\n", best.points, row.pcl_s,
                    best.read_s, best.extract_s, best.fit_s, best.total_s(), best.cpu_s, row.ratio(),
                    row.bytes_a_point());
        std::fflush(stdout);
    }
    fs::remove_all(folder);
    if (rows.size() > 1) {
        std::printf("time grows with the points to the power of %.2f\n", growth(rows.front(), rows.back()));
    }
    return asked.check && missed(rows) > 0 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("From a scan file to the fitted seam, beside PCL reading the same file: time and memory.");
    Asked asked;
    app.add_option("--points", asked.points, "of each scan, about, in ascending order")
        ->delimiter(',')
        ->check(CLI::Range(50'000, 100'000'000))
        ->capture_default_str();
    app.add_option("--repeats", asked.repeats, "runs of each; the best counts")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_flag("--check", asked.check, "exit status 1 when a target is missed");
    CLI11_PARSE(app, argc, argv);
    try {
        return run(asked);
    } catch (const std::exception& error) {
        std::cerr << error.what() << "\n";
        return 2;
    }
}
