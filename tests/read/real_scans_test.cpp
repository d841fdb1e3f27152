#include <filesystem>
#include <ostream>

#include "tests/read/support.hpp"

namespace seampath::read_test {
namespace real_scans_test {

namespace fs = std::filesystem;

struct RealScan {
    const char* file;
    const char* format;
    std::size_t points;
    std::uint64_t dropped;
    std::uint32_t width;
    std::uint32_t height;
    double size_mm;  ///< largest side of the box around all points
};

void PrintTo(const RealScan& scan, std::ostream* out) {
    *out << scan.file;
}

class ReadRealScan : public ::testing::TestWithParam<RealScan> {};

TEST_P(ReadRealScan, HasItsPointsUnitAndRaster) {
    const RealScan& expected = GetParam();
    const fs::path folder = fs::path(SEAMPATH_SOURCE_DIR) / ".." / "shared" / "scans";
    if (!fs::exists(folder)) {
        GTEST_SKIP() << "the real scans are not on this machine: " << folder;
    }
    const Scan scan = read(folder / expected.file, {});
    expect_invariants(scan);
    EXPECT_EQ(scan.format, expected.format);
    EXPECT_EQ(scan.points.size(), expected.points);
    EXPECT_EQ(scan.dropped_not_finite, expected.dropped);
    EXPECT_EQ(scan.points_in_file, expected.points + expected.dropped);
    EXPECT_EQ(scan.width, expected.width);
    EXPECT_EQ(scan.height, expected.height);
    EXPECT_EQ(scan.sensor_mm.has_value(), expected.width > 0);
    EXPECT_EQ(scan.mm_per_unit, 1000);
    EXPECT_EQ(scan.origin_mm, Eigen::Vector3d(0, 0, 0));
    Eigen::Vector3f low = scan.points[0];
    Eigen::Vector3f high = low;
    for (const auto& p : scan.points) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    EXPECT_NEAR(static_cast<double>((high - low).maxCoeff()), expected.size_mm, 0.01);
}

constexpr const char* kLittle = "ply binary_little_endian";
constexpr const char* kPacked = "pcd binary_compressed";
constexpr const char* kAscii = "pcd ascii";

// Counts and sizes were found by a separate program that knows nothing of these readers.
INSTANTIATE_TEST_SUITE_P(
    All, ReadRealScan,
    ::testing::Values(RealScan{"boxes/caixa.ply", kLittle, 46370, 0, 0, 0, 919.286},
                      RealScan{"boxes/caixa2.ply", kLittle, 16145, 0, 0, 0, 770.250},
                      RealScan{"boxes/caixa7.ply", kLittle, 8558, 0, 0, 0, 209.787},
                      RealScan{"rgbd/learn17.pcd", kPacked, 197828, 109372, 640, 480, 987.858},
                      RealScan{"rgbd/learn33.pcd", kPacked, 179131, 128069, 640, 480, 1028.000},
                      RealScan{"rgbd/learn36.pcd", kPacked, 171863, 135337, 640, 480, 1028.000},
                      RealScan{"rgbd/table_scene_mug_stereo_textured.pcd", kPacked, 209280, 97920, 640, 480, 1902.690},
                      RealScan{"tee_lidar/cad_tee.ply", kLittle, 32, 0, 0, 0, 266.700},
                      RealScan{"tee_lidar/shape1_0deg_filtered.pcd", kAscii, 3266, 0, 0, 0, 164.161},
                      RealScan{"tee_lidar/shape1_45deg_filtered.pcd", kAscii, 5204, 0, 0, 0, 462.646},
                      RealScan{"tee_lidar/shape1_60deg_filtered.pcd", kAscii, 3131, 0, 0, 0, 203.149},
                      RealScan{"tee_lidar/shape1_90deg_filtered.pcd", kAscii, 3001, 0, 0, 0, 148.832},
                      RealScan{"tee_lidar/table_8in10in_tee_longclamps_x4y24_45.pcd", kAscii, 89957, 0, 0, 0, 979.330},
                      RealScan{"tee_lidar/table_8in10in_tee_x0y24.pcd", kAscii, 65205, 0, 0, 0, 791.977},
                      RealScan{"tee_lidar/table_8in10in_tee_x4y24_45.pcd", kAscii, 77393, 0, 0, 0, 788.585},
                      RealScan{"tube/coil_scan00.ply", kLittle, 99519, 0, 0, 0, 227.504}));

}  // namespace real_scans_test
}  // namespace seampath::read_test
