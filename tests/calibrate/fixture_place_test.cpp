#include "pipeline/fixture_place.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "tests/test_folder.hpp"

/// A run's program in the place that a fixture calibration says.
namespace seampath {
namespace fixture_place_test {

using Eigen::Vector3d;
using testing::HasSubstr;

constexpr double kNow = 1795669200;  // 2026-11-26T05:00:00Z

class FixturePlace : public testing::Test {
protected:
    TestFolder folder;
    Config config;

    /// A result of that date; a turn by 90 degrees about z, 3 um along x and 4 um along z, 20 urad about y.
    void write(const std::string& verdict, const std::string& date) {
        FixtureCalibration c;
        c.nominal.name = "jig";
        c.date = date;
        c.frame.base_from_part.linear() = Eigen::AngleAxisd(90 * kDegree, Vector3d::UnitZ()).toRotationMatrix();
        c.frame.base_from_part.translation() = Vector3d(1000, -200, 50);
        c.frame.covariance.diagonal() << 9e-6, 0, 16e-6, 0, 4e-10, 0;
        if (verdict != "pass") {
            c.frame.faults.push_back("moved");
        }
        config.plan.fixture = (folder.path() / "result.json").string();
        std::ofstream(config.plan.fixture) << fixture_result_json(c);
    }
    std::string refusal() {
        try {
            put_in_place(config, kNow);
            return "";
        } catch (const InputError& error) {
            return error.what();
        }
    }
};

TEST_F(FixturePlace, TakesThePlaceOfBaseFromScan) {
    EXPECT_FALSE(put_in_place(config, kNow));
    write("pass", "2026-11-26T03:00:00Z");
    ASSERT_TRUE(put_in_place(config, kNow));
    const double h = std::sqrt(0.5);
    const std::vector<double> expected{1000, -200, 50, h, 0, 0, h};
    EXPECT_THAT(config.export_.base_from_scan, testing::Pointwise(testing::DoubleNear(1e-12), expected));
    EXPECT_NEAR(*config.export_.base_from_scan_sigma_mm, 4e-3, 1e-12);
    EXPECT_NEAR(*config.export_.base_from_scan_sigma_deg, 2e-5 / kDegree, 1e-12);
}

// A waypoint 100 mm along the part's x, which is base y: the turn about base y does not move it. Travel along part x is
// base y, so that base x and z remain, of 3 and 4 um. One along part y (base -x) is lifted by 100 mm times 20 urad.
TEST_F(FixturePlace, ItsUncertaintyJoinsThatOfTheWaypoints) {
    write("pass", "2026-11-26T03:00:00Z");
    const auto fixture = put_in_place(config, kNow);
    Plan plan;
    plan.waypoints.resize(2);
    plan.waypoints[0].p = Vector3d(100, 0, 0);
    plan.waypoints[0].sigma_mm = 3e-3;
    plan.waypoints[1].p = Vector3d(0, 100, 0);
    add_place_sigma(*fixture, plan);
    EXPECT_NEAR(plan.waypoints[0].sigma_mm, 5e-3, 1e-9);
    EXPECT_NEAR(plan.waypoints[1].sigma_mm, std::hypot(4e-3, 2e-3), 1e-9);
}

TEST_F(FixturePlace, RefusesWhatFailedOrIsOldOrContradicts) {
    write("fail", "2026-11-26T03:00:00Z");
    EXPECT_THAT(refusal(), HasSubstr("did not pass"));
    write("pass", "2026-11-25T03:00:00Z");
    EXPECT_EQ(refusal(), "");
    config.export_ = {};
    config.plan.fixture_max_age_h = 24;
    EXPECT_THAT(refusal(), HasSubstr("is 26.0 h old; at most 24 h were allowed"));
    write("pass", "2026-11-26T06:30:00Z");
    EXPECT_THAT(refusal(), HasSubstr("1.5 h ahead of this machine's clock"));
    config.export_.base_from_scan[0] = 5;
    EXPECT_THAT(refusal(), HasSubstr("both say where the scan stands"));
    config.export_ = {};
    config.plan.fixture = (folder.path() / "none.json").string();
    EXPECT_NE(refusal(), "");
}

}  // namespace fixture_place_test
}  // namespace seampath
