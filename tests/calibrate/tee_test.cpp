#include <algorithm>
#include <cmath>
#include <iostream>

#include <gtest/gtest.h>

#include "stages/calibrate/calibrate.hpp"
#include "stages/read/read.hpp"

/// The drawing of a tee of square tubes, laid on its three scans by a lidar of 0.75 mm. The tee lies on a table, which
/// its drawing does not have: an independent truth for height and tilt.
namespace seampath {
namespace tee_test {

using Eigen::Vector3d;

const std::filesystem::path kTees = std::filesystem::path(SEAMPATH_SOURCE_DIR) / "../shared/scans/tee_lidar";
constexpr double kHalfTube = 25.4;

BestFit fit(const std::string& placement, WeakDirection weak) {
    const Scan scan = read(kTees / ("table_8in10in_tee_" + placement + ".pcd"), {Unit::m});
    BestFitOptions options;
    options.scan_sensor_mm = Vector3d(0, 0, 800);  // the arm stands at the origin and looks down
    options.frame.limit_mm = 2;
    options.frame.trials = 1000;
    options.frame.weak = weak;
    return calibrate_surface(scan, read_surface(kTees / "cad_tee.ply", Unit::m, 100000),
                             {{"foot", {0, 0, 0}}, {"top", {0, 0, 241}}}, options);
}

/// Median height of the table about the foot.
double table_height(const std::string& placement, const Vector3d& foot) {
    const Scan scan = read(kTees / ("table_8in10in_tee_" + placement + ".pcd"), {Unit::m});
    std::vector<double> heights;
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
        const Vector3d p = scan.position(i);
        if ((p - foot).head<2>().norm() < 150 && p.z() < foot.z() - kHalfTube / 2) {
            heights.push_back(p.z());
        }
    }
    std::nth_element(heights.begin(), heights.begin() + static_cast<std::ptrdiff_t>(heights.size() / 2), heights.end());
    return heights[heights.size() / 2];
}

void expect_on_the_table(const std::string& placement, const BestFit& found) {
    const Vector3d foot = found.frame.work_points[0].in_base, top = found.frame.work_points[1].in_base;
    const double gap = foot.z() - kHalfTube - table_height(placement, foot);
    std::cout << placement << ": foot at " << foot.transpose() << ", " << gap << " mm off the table, post "
              << std::acos((top - foot).normalized().z()) * 180 / std::acos(-1.0) << " deg off upright, scatter "
              << found.scale_mm << " mm, 95 % within " << found.frame.work_points[0].expanded_mm << " and "
              << found.frame.work_points[1].expanded_mm << " mm\n";
    EXPECT_LT(std::abs(gap), 2.5) << "the table is scanned as 1 mm rough, and slopes by 4 mm";
    EXPECT_GT((top - foot).normalized().z(), std::cos(0.03));
    EXPECT_LT(found.scale_mm, 1.5);
}

class Tee : public testing::Test {
protected:
    void SetUp() override {
        if (!std::filesystem::exists(kTees)) {
            GTEST_SKIP() << "the real scans are not on this machine";
        }
    }
};

TEST_F(Tee, TheDrawingLiesOnTheScansThatHoldIt) {
    for (const char* placement : {"x4y24_45", "longclamps_x4y24_45"}) {
        const BestFit found = fit(placement, WeakDirection::refuse);
        EXPECT_TRUE(found.frame.pass()) << found.frame.faults.front();
        expect_on_the_table(placement, found);
    }
}

// Seen head on, no face of the tee looks along the bar: that one direction stays as the search found it.
TEST_F(Tee, TheScanThatLeavesItsLengthOpenSaysSo) {
    const BestFit found = fit("x0y24", WeakDirection::freeze);
    ASSERT_EQ(found.frame.weak.size(), 1U);
    EXPECT_EQ(found.frame.weak[0].text, "shift along (1.000, 0.000, 0.000)");
    EXPECT_TRUE(found.frame.pass()) << found.frame.faults.front();
    expect_on_the_table("x0y24", found);
}

}  // namespace tee_test
}  // namespace seampath
