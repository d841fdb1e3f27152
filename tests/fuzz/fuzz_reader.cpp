#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "stages/error.hpp"
#include "stages/read/read.hpp"

/// libFuzzer target of the reader of SEAMPATH_FUZZ_FORMAT: any bytes give a scan that keeps its promises, or an
/// InputError.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace seampath;
    // So wide that the largest face a file can hold gives about a hundred points: the time goes into reading.
    const ReadOptions options{.unit = Unit::automatic, .mesh_spacing_mm = 1e11};
    try {
        const Scan scan =
            read_bytes(std::as_bytes(std::span(data, size)), ScanFormat::SEAMPATH_FUZZ_FORMAT, "fuzz", options);
        ensure(!scan.points.empty(), "a scan has points");
        ensure(scan.origin_mm.allFinite(), "the origin is finite");
        ensure(scan.normals.empty() || scan.normals.size() == scan.points.size(), "one normal a point, or none");
        ensure(scan.pixel.empty() || scan.pixel.size() == scan.points.size(), "one pixel a point, or none");
        ensure(scan.dropped_not_finite <= scan.points_in_file, "no more dropped than read");
        for (const auto& p : scan.points) {
            ensure(p.allFinite(), "points are finite");
        }
        for (const auto& n : scan.normals) {
            ensure(std::abs(n.norm() - 1) < 1e-5F, "normals are unit");
        }
        for (std::size_t i = 0; i < scan.pixel.size(); ++i) {
            ensure(scan.pixel[i] < std::uint64_t{scan.width} * scan.height, "pixels are in the raster");
            ensure(i == 0 || scan.pixel[i - 1] < scan.pixel[i], "pixels ascend");
        }
    } catch (const InputError&) {
        return 0;
    }
    return 0;
}
