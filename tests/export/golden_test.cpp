#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "stages/export/export.hpp"
#include "tests/export/plans.hpp"

/// Programs of one small plan, byte for byte. After a change that is meant, run the tests once with
/// SEAMPATH_UPDATE_GOLDEN=1 in the environment, and review the difference of tests/golden as you would review code.
namespace seampath {
namespace golden_test {

namespace fs = std::filesystem;

std::string content(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

void expect_golden(const std::string& folder, const ExportOptions& options, const Plan& plan) {
    const fs::path golden = fs::path(SEAMPATH_SOURCE_DIR) / "tests" / "golden" / folder;
    const char* update = std::getenv("SEAMPATH_UPDATE_GOLDEN");
    for (const ProgramFile& file : export_programs(plan, options)) {
        if (update != nullptr && std::string(update) == "1") {
            fs::create_directories(golden);
            std::ofstream(golden / file.file_name, std::ios::binary) << file.content;
        }
        ASSERT_TRUE(fs::exists(golden / file.file_name)) << "make it with SEAMPATH_UPDATE_GOLDEN=1";
        EXPECT_EQ(file.content, content(golden / file.file_name)) << "if meant: SEAMPATH_UPDATE_GOLDEN=1";
    }
}

TEST(Golden, ProgramsThatWeldInAMovedFrame) {
    ExportOptions options = test::arc_options();
    options.program_name = "golden";
    options.abb_tool = "tTorch";
    options.abb_work_object = "wPart";
    options.ur_tcp = {0, -12.5, 380, 0, 0.5, 0};
    options.base_from_scan_sigma_mm = 0.12;
    options.base_from_scan_sigma_deg = 0.02;
    options.base_from_scan = {1200, -340, 75.5, 0.5, 0.5, -0.5, 0.5};
    options.robots = test::robots_without("linuxcnc");
    expect_golden("weld", options, test::golden_plan());
    options.robots = "linuxcnc";
    options.base_from_scan = {1200, -340, 75.5, 1, 0, 0, 0};
    expect_golden("weld", options, test::golden_plan_for("linuxcnc"));
}

TEST(Golden, ProgramsThatOnlyMove) {
    ExportOptions options = test::cell_options();
    options.program_name = "golden";
    options.robots = test::robots_without("linuxcnc");
    expect_golden("move", options, test::golden_plan());
    options.robots = "linuxcnc";
    expect_golden("move", options, test::golden_plan_for("linuxcnc"));
}

// Each robot's own arm goes through the air by its axes; ROS gets all of its travel.
TEST(Golden, ProgramsOfAnArm) {
    ExportOptions options = test::arc_options();
    options.program_name = "arm";
    for (const char* robot : {"abb", "kuka", "fanuc", "ur", "yaskawa", "ros"}) {
        options.robots = robot;
        options.arm_robot = options.robots == "ros" ? "" : robot;
        expect_golden("arm", options, test::arm_plan());
    }
}

// A weld along half a circle, at numbers that every machine computes alike.
TEST(Golden, ProgramsWithArcs) {
    std::vector<Waypoint> waypoints;
    const Eigen::Quaterniond down(0, 1, 0, 0);
    waypoints.push_back(test::waypoint(0, WaypointKind::approach, 0, {50, 0, 30}, down, 100));
    for (int k = 0; k <= 32; ++k) {
        const double t = k / 32.0;  // (1 - t^2, 2 t) / (1 + t^2) is on the circle
        const Eigen::Vector3d p(50 * (1 - t * t) / (1 + t * t), 100 * t / (1 + t * t), 0);
        const WaypointKind kind = k == 0    ? WaypointKind::weld_start
                                  : k == 32 ? WaypointKind::weld_end
                                            : WaypointKind::weld;
        waypoints.push_back(test::waypoint(0, kind, 2.5 * k, p, down, k == 0 ? 100 : 8.5));
    }
    waypoints.push_back(test::waypoint(0, WaypointKind::retract, 80, {0, 50, 30}, down, 100));
    ExportOptions options = test::arc_options();
    options.program_name = "arc";
    options.kuka_spline = true;
    options.robots = "abb,kuka,fanuc,ur,yaskawa";
    expect_golden("arc", options, test::finished(waypoints));
}

}  // namespace golden_test
}  // namespace seampath
