#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/fixtures/surface_scenes.hpp"
#include "stages/calibrate/calibrate.hpp"
#include "stages/error.hpp"

/// A scan laid on a nominal surface.
namespace seampath {
namespace best_fit_test {

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

}  // namespace best_fit_test
}  // namespace seampath
