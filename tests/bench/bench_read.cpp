#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <unistd.h>

#include "stages/read/read.hpp"

/// Reads the same files with Seampath and with PCL: first each point of both is compared, then both are timed.
namespace {

namespace fs = std::filesystem;
using PclCloud = pcl::PointCloud<pcl::PointXYZ>;

constexpr std::size_t kManyPoints = 10'000'000;
constexpr std::size_t kFewerPoints = 1'000'000;
const fs::path kFolder = fs::temp_directory_path() / ("seampath-bench-" + std::to_string(::getpid()));

PclCloud wavy_plate(std::size_t count) {
    PclCloud cloud;
    cloud.reserve(count);
    constexpr std::size_t kRow = 4000;
    for (std::size_t i = 0; i < count; ++i) {
        const float x = 0.1F * static_cast<float>(i % kRow);
        const float y = 0.1F * static_cast<float>(i / kRow);
        cloud.emplace_back(x, y, std::sin(0.05F * x) * std::cos(0.03F * y));
    }
    return cloud;
}

PclCloud load_with_pcl(const fs::path& file) {
    PclCloud cloud;
    const int status = file.extension() == ".ply" ? pcl::io::loadPLYFile(file.string(), cloud)
                                                  : pcl::io::loadPCDFile(file.string(), cloud);
    if (status < 0) {
        std::cerr << file << ": PCL cannot read it\n";
        std::exit(1);
    }
    return cloud;
}

/// Ends the program at the first point that is not the one that PCL reads.
void compare(const fs::path& file, seampath::Unit unit) {
    const seampath::Scan scan = seampath::read(file, {.unit = unit});
    const PclCloud cloud = load_with_pcl(file);
    std::size_t taken = 0;
    for (const auto& p : cloud) {
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
            continue;
        }
        const Eigen::Vector3d expected = p.getVector3fMap().cast<double>() * scan.mm_per_unit;
        const double tolerance = 1e-6 * (1 + expected.norm());
        if (taken == scan.points.size() || !((scan.position(taken) - expected).norm() <= tolerance)) {
            std::cerr << file << ": point " << taken << " is not the one that PCL reads\n";
            std::exit(1);
        }
        ++taken;
    }
    if (taken != scan.points.size()) {
        std::cerr << file << ": " << scan.points.size() << " points, but PCL reads " << taken << "\n";
        std::exit(1);
    }
    std::cerr << file.filename().string() << ": " << taken << " points equal PCL's\n";
}

std::vector<fs::path> write_files() {
    fs::create_directories(kFolder);
    const auto file = [](const char* name) { return (kFolder / name).string(); };
    const PclCloud many = wavy_plate(kManyPoints);
    pcl::io::savePLYFileBinary(file("binary.ply"), many);
    pcl::io::savePCDFileBinary(file("binary.pcd"), many);
    pcl::io::savePCDFileBinaryCompressed(file("compressed.pcd"), many);
    const PclCloud fewer = wavy_plate(kFewerPoints);
    pcl::io::savePLYFileASCII(file("ascii.ply"), fewer);
    pcl::io::savePCDFileASCII(file("ascii.pcd"), fewer);
    return {file("binary.ply"), file("binary.pcd"), file("compressed.pcd"), file("ascii.ply"), file("ascii.pcd")};
}

void compare_real_scans() {
    const fs::path folder = fs::path(SEAMPATH_SOURCE_DIR) / ".." / "shared" / "scans";
    if (!fs::exists(folder)) {
        std::cerr << "no real scans in " << folder << ": not compared\n";
        return;
    }
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        const fs::path& file = entry.path();
        // PCL leaves all points at 0 where a file holds doubles, as those of boxes/ do.
        const bool doubles = file.parent_path().filename() == "boxes";
        if (!doubles && (file.extension() == ".ply" || file.extension() == ".pcd")) {
            compare(file, seampath::Unit::m);
        }
    }
}

struct Reader {
    std::string name;
    void (*load)(const fs::path&);
};

void time_reader(benchmark::State& state, void (*load)(const fs::path&), const fs::path& file) {
    for (auto _ : state) {
        load(file);
    }
}

}  // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    for (const fs::path& file : write_files()) {
        compare(file, seampath::Unit::mm);
        const std::string name = file.filename().string();
        for (const Reader& reader :
             {Reader{"seampath/", [](const fs::path& f) { benchmark::DoNotOptimize(seampath::read(f, {})); }},
              Reader{"pcl/", [](const fs::path& f) { benchmark::DoNotOptimize(load_with_pcl(f)); }}}) {
            benchmark::RegisterBenchmark((reader.name + name).c_str(), time_reader, reader.load, file)
                ->Unit(benchmark::kMillisecond)
                ->UseRealTime();
        }
    }
    compare_real_scans();
    benchmark::RunSpecifiedBenchmarks();
    fs::remove_all(kFolder);
}
