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

// One scan laid on another of the same part: what both are off adds up.
TEST(BestFit, AGoldenScanServesAsNominal) {
    SurfaceScene scene;
    scene.part = FixturePart::bracket;
    scene.width = 320;
    scene.height = 235;
    const SurfaceScan golden = make_surface_scan(scene, 6);
    Scan part = golden.made.scan;  // what of it lies on the table is cut off
    const Eigen::Isometry3d part_from_base = golden.made.base_from_part.inverse();
    std::erase_if(part.points, [&](const Eigen::Vector3f& p) {
        const Vector3d q = part_from_base * (part.origin_mm + p.cast<double>());
        return q.z() < 1 || (q.array() < -1).any() || q.x() > 181 || q.y() > 121;
    });
    const SurfaceScan seen = make_surface_scan(scene, 12);
    BestFitOptions options;
    options.least_share = 0.3;
    const BestFit fit = calibrate_surface(seen.made.scan, part, kCorner, options);
    if (fit.frame.pass()) {
        const Eigen::Isometry3d truth = seen.made.base_from_part * part_from_base;
        EXPECT_LT((fit.frame.base_from_part * part.origin_mm - truth * part.origin_mm).norm(), 0.05);
    } else {
        ADD_FAILURE() << fit.frame.faults.front();
    }
}

// Of the bracket: the base's top, the upright's inner side, and the side that both end in.
TEST(ScannedPlanes, GiveTheFrameByPrecedence) {
    SurfaceScene scene;
    scene.part = FixturePart::bracket;
    scene.width = 320;
    scene.height = 235;
    const std::vector<PlaneFace> planes{
        {"A", {0, 0, 1}, 10, {{10, 0, 10}, {180, 0, 10}, {180, 120, 10}, {10, 120, 10}}},
        {"B", {1, 0, 0}, 10, {{10, 0, 10}, {10, 120, 10}, {10, 120, 110}, {10, 0, 110}}},
        {"C", {0, -1, 0}, 0, {{0, 0, 0}, {180, 0, 0}, {180, 0, 10}, {10, 0, 110}, {0, 0, 110}}}};
    for (std::uint64_t seed = 1; seed < 200; ++seed) {  // the first from which all three are seen
        const SurfaceScan seen = make_surface_scan(scene, seed);
        const Eigen::Isometry3d& truth = seen.made.base_from_part;
        const Vector3d eye = truth.inverse() * *seen.made.scan.sensor_mm;
        if (eye.x() < 250 || eye.y() > -250) {
            continue;
        }
        const FrameResult r = calibrate_scanned_planes(seen.made.scan, planes, kCorner, {});
        ASSERT_TRUE(r.pass()) << r.faults.front();
        EXPECT_LT((r.base_from_part * kCorner[0].p - truth * kCorner[0].p).norm(), 0.02);
        EXPECT_EQ(r.features.size(), 3u);
        return;
    }
    FAIL() << "no view of all three planes";
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
