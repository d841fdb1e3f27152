#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "stages/export/export.hpp"
#include "stages/geometry/arc.hpp"
#include "stages/geometry/pose.hpp"
#include "stages/nominal/nominal.hpp"
#include "stages/plan/plan.hpp"
#include "tests/export/plans.hpp"
#include "tests/plan/models.hpp"
#include "tests/test_folder.hpp"

/// Programs on LinuxCNC's whole controller, in simulation, driving an arm: what the arm does is what was planned.
namespace seampath {
namespace controller_test {

namespace fs = std::filesystem;

constexpr double kDeg = std::numbers::pi / 180;

struct Pose {
    Eigen::Vector3d p;
    Eigen::Quaterniond q;
};

// Forward kinematics of the UR10e by its published dimensions, in the standard convention of Denavit and Hartenberg;
// the controller has the modified one. Joint angles in deg.
Pose tool_of(const std::array<double, 6>& joints_deg) {
    constexpr std::array<double, 6> d{180.7, 0, 0, 174.15, 119.85, 116.55};
    constexpr std::array<double, 6> a{0, -612.7, -571.55, 0, 0, 0};
    constexpr std::array<double, 6> alpha{90, 0, 0, 90, -90, 0};
    Eigen::Isometry3d base_from_link = Eigen::Isometry3d::Identity();
    for (std::size_t i = 0; i < 6; ++i) {
        base_from_link.rotate(Eigen::AngleAxisd(joints_deg[i] * kDeg, Eigen::Vector3d::UnitZ()));
        base_from_link.translate(Eigen::Vector3d(a[i], 0, d[i]));
        base_from_link.rotate(Eigen::AngleAxisd(alpha[i] * kDeg, Eigen::Vector3d::UnitX()));
    }
    return {base_from_link.translation(), Eigen::Quaterniond(base_from_link.linear())};
}

struct Sample {
    Pose tool;
    bool arc = false;
};

// A millisecond each; throws where one is missing.
std::vector<Sample> samples_of(const fs::path& log) {
    std::vector<Sample> samples;
    std::ifstream in(log);
    long number = 0, last = -1;
    for (std::array<double, 6> joints{}; in >> number;) {
        for (double& joint : joints) {
            in >> joint;
        }
        int arc = 0, line = 0;
        in >> arc >> line;
        if (last >= 0 && number != last + 1) {
            throw std::runtime_error("a sample is missing behind " + std::to_string(last));
        }
        last = number;
        samples.push_back({tool_of(joints), arc != 0});
    }
    return samples;
}

struct Followed {
    double distance_mm = 0;  // largest, of the tool from the planned path
    double angle_deg = 0;    // largest, from the orientation planned there
    double passed_mm = 0;    // largest, of a waypoint from the tool's path
    double seconds = 0;      // from the first waypoint to the last
    double arc_mm = 0;       // largest, of the tool from where the arc is to be switched
};

// Of samples from the first waypoint, where the arm need not rest for a whole millisecond, to its rest in the last.
Followed follow(const std::vector<Sample>& samples, const std::vector<Waypoint>& plan) {
    const auto away = [&](std::size_t i, const Waypoint& w) { return (samples[i].tool.p - w.p).norm(); };
    std::size_t first = 0, last = samples.size() - 1;
    while (first < last && away(first, plan.front()) > 0.2) {
        ++first;
    }
    while (first < last && away(first + 1, plan.front()) <= away(first, plan.front())) {
        ++first;
    }
    while (last > first && away(last - 1, plan.back()) < 1e-3) {
        --last;
    }
    Followed worst;
    worst.seconds = 1e-3 * static_cast<double>(last - first);
    std::size_t segment = 0;
    std::vector<double> nearest(plan.size(), std::numeric_limits<double>::infinity());
    for (std::size_t i = first; i <= last; ++i) {
        const Pose& tool = samples[i].tool;
        // The tool goes on along the plan: the nearest of the next few segments.
        NearestOnPath found{std::numeric_limits<double>::infinity(), 0};
        for (std::size_t k = segment; k < std::min(segment + 6, plan.size() - 1); ++k) {
            const NearestOnPath one = nearest_on_segment(tool.p, plan[k].p, plan[k + 1].p);
            if (one.distance_mm < found.distance_mm - 1e-9) {
                found = one;
                segment = k;
            }
        }
        const Eigen::Quaterniond planned = plan[segment].q.slerp(found.fraction, plan[segment + 1].q);
        worst.distance_mm = std::max(worst.distance_mm, found.distance_mm);
        worst.angle_deg = std::max(worst.angle_deg, rotation_angle(planned, tool.q) / kDeg);
        for (std::size_t k = segment; k <= segment + 1; ++k) {
            nearest[k] = std::min(nearest[k], (tool.p - plan[k].p).norm());
        }
        if (i > first && samples[i].arc != samples[i - 1].arc) {
            double nearest_event = std::numeric_limits<double>::infinity();
            for (const Waypoint& w : plan) {
                if (w.kind == (samples[i].arc ? WaypointKind::weld_start : WaypointKind::weld_end)) {
                    nearest_event = std::min(nearest_event, away(i, w));
                }
            }
            worst.arc_mm = std::max(worst.arc_mm, nearest_event);
        }
    }
    worst.passed_mm = *std::max_element(nearest.begin(), nearest.end());
    return worst;
}

// In front of the arm, a hand above the floor; the arm's home is over it.
const std::vector<double> kPart{600, -174, 100, 1, 0, 0, 0};

struct Case {
    const char* name;
    std::vector<SeamModel> models;
    double speed_mm_s;
    std::size_t seams;
};

std::vector<Case> cases() {
    SaddleDimensions dimensions;
    dimensions.branch_radius_mm = 20;
    dimensions.header_radius_mm = 50;
    const SeamModel saddle = nominal_model(saddle_of(dimensions), PoseLaw::bisector, 0);
    const SeamModel s_curve = test::model_of(test::s_curve(100, 10), false, 120);
    const SeamModel line = test::model_of(test::line(40), false, 12);
    Eigen::Isometry3d aside = Eigen::Isometry3d::Identity();
    aside.translate(Eigen::Vector3d(10, 50, 0)).rotate(Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ()));
    const SeamModel other = test::model_of(test::moved(test::line(40), aside), false, 12);
    return {{"saddle", {saddle}, 11, 1}, {"S-curve", {s_curve}, 10, 1}, {"two seams", {line, other}, 8.5, 2}};
}

TEST(Controller, ArmFollowsThePlanInPlaceAndTime) {
    if (std::system("command -v linuxcnc > /dev/null && command -v halsampler > /dev/null") != 0) {
        GTEST_SKIP() << "linuxcnc-uspace is not installed";
    }
    const TestFolder folder;
    const fs::path run = fs::path(SEAMPATH_SOURCE_DIR) / "tests" / "export" / "controller" / "run";
    for (const Case& c : cases()) {
        SCOPED_TRACE(c.name);
        PlanOptions how;
        how.speed_mm_s = c.speed_mm_s;
        how.air_speed_mm_s = 50;
        how.approach_mm = how.retract_mm = 15;
        const Plan planned = plan(c.models, how);
        ExportOptions options;
        options.robots = "linuxcnc,csv";
        options.linuxcnc_arc_output = 1;
        options.base_from_scan = kPart;
        const std::vector<ProgramFile> files = export_programs(planned, options);
        std::ofstream(folder.path() / "program.ngc") << files[0].content;
        const std::string command =
            run.string() + " " + (folder.path() / "program.ngc").string() + " " + (folder.path() / "log").string();
        ASSERT_EQ(std::system(command.c_str()), 0);

        std::vector<Waypoint> in_base = planned.waypoints;
        for (Waypoint& w : in_base) {
            w.p += Eigen::Vector3d(kPart[0], kPart[1], kPart[2]);
        }
        const std::vector<Sample> samples = samples_of(folder.path() / "log");
        const Followed followed = follow(samples, in_base);
        EXPECT_LT(followed.distance_mm, 0.05);
        EXPECT_LT(followed.angle_deg, 0.01);
        EXPECT_LT(followed.passed_mm, 0.05);
        EXPECT_LT(followed.arc_mm, 0.05);
        EXPECT_NEAR(followed.seconds / planned.duration_s, 1, 0.01);
        std::size_t strikes = 0;
        for (std::size_t i = 1; i < samples.size(); ++i) {
            strikes += samples[i].arc && !samples[i - 1].arc ? 1 : 0;
        }
        EXPECT_EQ(strikes, c.seams);
        std::cout << c.name << ": " << followed.distance_mm << " mm, " << followed.angle_deg
                  << " deg, waypoints passed at " << followed.passed_mm << " mm, arc at " << followed.arc_mm << " mm, "
                  << followed.seconds << " s for " << planned.duration_s << " s\n";
    }
}

}  // namespace controller_test
}  // namespace seampath
