#include <algorithm>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "datasets/surface_scenes.hpp"
#include "stages/calibrate/calibrate.hpp"
#include "stages/error.hpp"
#include "tests/cli/spawn.hpp"

/// A scan laid on a nominal surface.
namespace seampath {
namespace best_fit_test {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using testing::HasSubstr;

SurfaceScan small_scan() {
    SurfaceScene scene;
    scene.part = FixturePart::housing;
    scene.width = 256;
    scene.height = 188;
    return make_surface_scan(scene, 3);
}

Scan nominal_housing() {
    return sampled_mesh(part_mesh(FixturePart::housing), 100000, "housing");
}

const std::vector<WorkPoint> kCorner{{"corner", {160, 110, 60}}};

TEST(BestFit, OrderOfPointsChangesNothing) {
    const SurfaceScan seen = small_scan();
    Scan turned = seen.made.scan;
    std::reverse(turned.points.begin(), turned.points.end());
    const BestFit a = calibrate_surface(seen.made.scan, nominal_housing(), kCorner, {}),
                  b = calibrate_surface(turned, nominal_housing(), kCorner, {});
    EXPECT_TRUE(a.frame.pass()) << a.frame.faults.front();
    EXPECT_EQ(a.frame.base_from_part.matrix(), b.frame.base_from_part.matrix());
    EXPECT_EQ(a.frame.covariance, b.frame.covariance);
}

TEST(BestFit, SaysWhatItLacks) {
    const auto message = [](const Scan& scan, const Scan& nominal) -> std::string {
        try {
            calibrate_surface(scan, nominal, {}, {});
            return "";
        } catch (const InputError& error) {
            return error.what();
        }
    };
    Scan few = nominal_housing();
    few.points.resize(10);
    few.normals.resize(10);
    EXPECT_THAT(message(few, nominal_housing()), HasSubstr("has 10 points; at least 1000 were needed"));
    Scan blind = nominal_housing();
    blind.normals.clear();
    EXPECT_THAT(message(blind, nominal_housing()), HasSubstr("nothing says from which side"));
}

// The tee's CAD on three scans of a turning line lidar. Its noise is 0.75 mm; the tubes' own size is within some tenths
// of their nominal one, and the tee has no two planes that its scans show twice.
TEST(BestFit, TheTeesCadLiesOnItsScans) {
    const fs::path folder = fs::path(SEAMPATH_SOURCE_DIR) / ".." / "shared" / "scans" / "tee_lidar";
    if (!fs::exists(folder)) {
        GTEST_SKIP() << "the real scans are not on this machine";
    }
    const TestFolder test;
    const fs::path nominal = test.path() / "tee.json";
    std::ofstream(nominal) << R"({"name": "tee", "method": "best-fit", "surface": ")"
                           << fs::absolute(folder / "cad_tee.ply").string()
                           << R"(", "surface_unit": "m", "sensor_mm": [0, -300, 600], "least_share": 0.1,
  "work_points": [{"name": "joint", "p_mm": [0, 0, 25.4]}], "limit_mm": 1})";
    for (const char* scan :
         {"table_8in10in_tee_x0y24", "table_8in10in_tee_x4y24_45", "table_8in10in_tee_longclamps_x4y24_45"}) {
        const fs::path file = folder / (std::string(scan) + ".pcd");
        const Outcome run = seampath_program(
            {"calibrate", "fixture", file, "--nominal", nominal, "--out", test.path() / scan, "--json"});
        EXPECT_EQ(run.status, 0) << scan << "\n" << run.out << run.err;
    }
}

}  // namespace best_fit_test
}  // namespace seampath
