#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stages/error.hpp"
#include "stages/export/format.hpp"
#include "stages/geometry/pose.hpp"
#include "stages/plan/plan.hpp"
#include "tests/export/plans.hpp"
#include "tests/geometry/arms.hpp"
#include "tests/plan/models.hpp"
#include "tests/test_folder.hpp"

/// What programs of others make of our files. Each test is skipped where its program is not installed.
namespace seampath {
namespace clients_test {

namespace fs = std::filesystem;

constexpr double kDeg = std::numbers::pi / 180;

struct Ran {
    int status = -1;
    std::string out;
};

Ran run(const std::string& command) {
    Ran ran;
    FILE* const pipe = popen((command + " 2>&1").c_str(), "r");
    char buffer[4096];
    for (std::size_t size = 0; (size = fread(buffer, 1, sizeof buffer, pipe)) > 0;) {
        ran.out.append(buffer, size);
    }
    ran.status = pclose(pipe);
    return ran;
}

std::string source(const std::string& file) {
    return (fs::path(SEAMPATH_SOURCE_DIR) / "tests" / "export" / "clients" / file).string();
}

std::vector<ProgramFile> programs(const Plan& plan, const std::string& robot, ExportOptions options) {
    options.robots = robot;
    return export_programs(plan, options);
}

void write_files(const std::vector<ProgramFile>& files, const fs::path& folder) {
    for (const ProgramFile& file : files) {
        std::ofstream(folder / file.file_name, std::ios::binary) << file.content;
    }
}

// A canonical move of LinuxCNC's interpreter: x, y, z mm, a, b, c deg, and the feed in force.
struct Canonical {
    std::vector<double> numbers;
    double feed = 0;
    bool output = false;  // behind the move
};

std::vector<Canonical> canonical_moves(const std::string& text) {
    std::vector<Canonical> moves;
    std::istringstream in(text);
    double feed = 0;
    for (std::string line; std::getline(in, line);) {
        const auto open = line.find('(');
        const auto words = line.find_last_of(' ', open);
        const std::string name = line.substr(words + 1, open - words - 1);
        std::istringstream arguments(line.substr(open + 1));
        if (name == "SET_FEED_RATE") {
            arguments >> feed;
        } else if (name == "STRAIGHT_FEED") {
            Canonical move;
            move.feed = feed;
            for (double number = 0; arguments >> number; arguments.ignore(1)) {
                move.numbers.push_back(number);
            }
            moves.push_back(move);
        } else if (name == "SET_MOTION_OUTPUT_BIT" || name == "CLEAR_MOTION_OUTPUT_BIT") {
            moves.at(moves.size() - 1).output = true;
        }
        EXPECT_EQ(name.find("ARC_FEED"), std::string::npos);
    }
    return moves;
}

std::vector<Plan> plans_for_the_interpreter() {
    std::vector<Plan> plans{test::golden_plan_for("linuxcnc"), test::plan_with(Eigen::Quaterniond(0, 1, 0, 0)),
                            test::plan_with(from_euler_zyx(-30 * kDeg, -20 * kDeg, -170 * kDeg)),
                            test::plan_with(from_euler_zyx(0, 90 * kDeg, 0)),
                            test::plan_with(from_euler_zyx(0, -90 * kDeg, 0))};
    const std::vector<SeamModel> models{test::model_of(test::circle(40), true, 64),
                                        test::model_of(test::s_curve(200, 12), false, 120)};
    plans.push_back(plan(models, {}));
    std::mt19937_64 generator(21);
    for (int i = 0; i < 10; ++i) {
        Plan helix = test::random_helix(generator);
        const Eigen::Vector3d x = helix.waypoints.front().q * Eigen::Vector3d::UnitX();
        if (std::abs(x.z()) < 0.5) {
            plans.push_back(std::move(helix));
        }
    }
    return plans;
}

TEST(Clients, LinuxcncInterpretsEveryProgramAsItIsMeant) {
    if (run("command -v rs274").status != 0) {
        GTEST_SKIP() << "rs274 is not installed (linuxcnc-uspace)";
    }
    const TestFolder folder;
    const exporting::Format& format = exporting::kLinuxcnc;
    std::size_t interpreted = 0;
    for (const Plan& plan : plans_for_the_interpreter()) {
        for (const bool arc : {true, false}) {
            ExportOptions options = test::cell_options();
            if (arc) {
                options.linuxcnc_arc_output = 1;
            }
            std::vector<ProgramFile> files;
            try {
                files = programs(plan, "linuxcnc", options);
            } catch (const InputError&) {
                continue;  // too near to the gimbal
            }
            ++interpreted;
            write_files(files, folder.path());
            const Ran ran = run("cd " + folder.path().string() + " && rs274 -g " + files[0].file_name);
            ASSERT_EQ(ran.status, 0) << ran.out;
            const std::vector<Canonical> moves = canonical_moves(ran.out);
            const exporting::Program program = program_of(plan, format, options);
            ASSERT_EQ(moves.size(), program.targets.size());
            for (std::size_t k = 0; k < moves.size(); ++k) {
                const Waypoint& w = program.targets[k].at;
                const std::vector<double>& n = moves[k].numbers;
                ASSERT_EQ(n.size(), 6u);
                EXPECT_LT((Eigen::Vector3d(n[0], n[1], n[2]) - w.p).cwiseAbs().maxCoeff(), 1.01e-4);
                EXPECT_LT(rotation_angle(w.q, from_euler_zyx(n[5] * kDeg, n[4] * kDeg, n[3] * kDeg)), 2e-4 * kDeg);
                EXPECT_NEAR(moves[k].feed / (60 * w.speed_mm_s), 1, 1e-5);
                const bool event = w.kind == WaypointKind::weld_start || w.kind == WaypointKind::weld_end;
                EXPECT_EQ(moves[k].output, arc && event);
            }
        }
    }
    EXPECT_GE(interpreted, 15u);
}

TEST(Clients, RosMessagesTakeTheYaml) {
    if (run("/usr/bin/python3 -c 'import geometry_msgs, trajectory_msgs, genpy'").status != 0) {
        GTEST_SKIP() << "python3-geometry-msgs and python3-trajectory-msgs are not installed";
    }
    const TestFolder folder;
    for (const Plan& plan : {test::arm_plan(), test::plan_with(Eigen::Quaterniond(0, 1, 0, 0))}) {
        const auto files = programs(plan, "ros", test::arc_options());
        write_files(files, folder.path());
        const Ran ran = run("cd " + folder.path().string() + " && /usr/bin/python3 " + source("ros_messages.py") + " " +
                            files[0].file_name + " " + files[1].file_name + " " + (plan.arm ? files[2].file_name : ""));
        ASSERT_EQ(ran.status, 0) << ran.out;
        const std::string count = std::to_string(plan.waypoints.size());
        EXPECT_THAT(ran.out, testing::StartsWith("poses " + count + " points " + count + " frame base_link\nlast "));
        std::istringstream last(ran.out.substr(ran.out.find("last ") + 5));
        double x = 0, w = 0, ns = 0;
        last >> x >> w >> ns;
        EXPECT_NEAR(x, plan.waypoints.back().p.x() / 1000, 1e-12);
        EXPECT_NEAR(w, plan.waypoints.back().q.w(), 1e-12);
        if (!plan.arm) {
            EXPECT_NEAR(ns, 1e9 * plan.waypoints.back().time_s, 20);
            continue;
        }
        const std::vector<ArmSample>& samples = plan.arm->samples;
        EXPECT_NEAR(ns, 1e9 * samples.back().time_s, 20);
        EXPECT_THAT(ran.out, testing::HasSubstr("joints joint_1 joint_2 joint_3 joint_4 joint_5 joint_6 points " +
                                                std::to_string(samples.size()) + "\n"));
        std::istringstream axes(ran.out.substr(ran.out.find("axes ") + 5));
        for (const double planned : samples.back().q) {
            double axis = 0;
            axes >> axis;
            EXPECT_NEAR(axis, planned, 1e-12);
        }
    }
}

// NODE_PATH=FOLDER/node_modules, where "npm install @mcap/core" has been.
TEST(Clients, FoxglovesOwnReaderReadsTheBag) {
    const char* modules = std::getenv("NODE_PATH");
    if (modules == nullptr || !fs::exists(fs::path(modules) / "@mcap" / "core")) {
        GTEST_SKIP() << "no @mcap/core in NODE_PATH";
    }
    const TestFolder folder;
    write_files(programs(test::arm_plan(), "ros", test::arc_options()), folder.path());
    const Ran ran = run("node " + source("mcap_core.mjs") + " " + (folder.path() / "seampath.mcap").string());
    ASSERT_EQ(ran.status, 0) << ran.out;
    EXPECT_EQ(ran.out,
              "/seampath/poses geometry_msgs/msg/PoseArray ros2msg cdr 1\n"
              "/seampath/trajectory trajectory_msgs/msg/MultiDOFJointTrajectory ros2msg cdr 1\n"
              "/seampath/arc std_msgs/msg/Bool ros2msg cdr 4\n"
              "/seampath/joint_trajectory trajectory_msgs/msg/JointTrajectory ros2msg cdr 1\n"
              "messages 7 7\n");
}

Ran run_freecad(const std::string& script, const fs::path& file) {
    return run("FILE=" + file.string() + " QT_QPA_PLATFORM=offscreen freecadcmd " + source(script));
}

// Lines of six numbers or more behind a word.
std::vector<std::vector<double>> rows_of(const std::string& text, const std::string& word) {
    std::vector<std::vector<double>> rows;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);) {
        // Its progress is written on the same line.
        const auto at = line.find(word);
        if (at != std::string::npos) {
            std::istringstream numbers(line.substr(at + word.size()));
            rows.emplace_back(std::istream_iterator<double>(numbers), std::istream_iterator<double>());
        }
    }
    return rows;
}

TEST(Clients, FreecadReadsTheGcodeAsAPath) {
    if (run("command -v freecadcmd").status != 0) {
        GTEST_SKIP() << "freecadcmd is not installed (freecad)";
    }
    const TestFolder folder;
    const Plan plan = test::golden_plan_for("linuxcnc");
    ExportOptions options = test::arc_options();
    write_files(programs(plan, "linuxcnc", options), folder.path());
    const Ran ran = run_freecad("freecad_path.py", folder.path() / "seampath.ngc");
    const auto rows = rows_of(ran.out, "G1 ");
    const exporting::Program program = program_of(plan, exporting::kLinuxcnc, options);
    ASSERT_EQ(rows.size(), program.targets.size()) << ran.out;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        const Waypoint& w = program.targets[k].at;
        const std::vector<double>& n = rows[k];
        ASSERT_EQ(n.size(), 7u);
        EXPECT_LT((Eigen::Vector3d(n[0], n[1], n[2]) - w.p).cwiseAbs().maxCoeff(), 1.01e-4);
        EXPECT_LT(rotation_angle(w.q, from_euler_zyx(n[5] * kDeg, n[4] * kDeg, n[3] * kDeg)), 2e-4 * kDeg);
        EXPECT_NEAR(n[6] / (60 * w.speed_mm_s), 1, 1e-5);
    }
}

// FreeCAD has the maker's own table of the KR 16: at the axes that the program names, its flange is where the plan has
// it.
TEST(Clients, FreecadsKukaStandsWhereTheAxesOfTheProgramPutIt) {
    if (run("command -v freecadcmd").status != 0) {
        GTEST_SKIP() << "freecadcmd is not installed (freecad)";
    }
    const std::vector<SeamModel> models{
        test::model_of(test::line(100), false, 8),
        test::model_of(test::moved(test::line(100), Eigen::Isometry3d(Eigen::Translation3d(0, 150, 0))), false, 8)};
    ArmCell cell{
        load_arm("kuka-kr-16-2").arm, Eigen::Isometry3d(Eigen::Translation3d(900, 0, 300)),
        Eigen::Isometry3d(Eigen::Translation3d(40, 0, 300) * Eigen::AngleAxisd(35 * kDeg, Eigen::Vector3d::UnitY()))};
    const Plan planned = plan(models, {}, cell);
    ASSERT_TRUE(planned.arm->pass) << planned.arm->verdict;
    ExportOptions options = test::cell_options();
    options.arm_robot = "kuka";
    options.base_from_scan = {900, 0, 300, 1, 0, 0, 0};
    const TestFolder folder;
    write_files(programs(planned, "kuka", options), folder.path());
    const Ran ran = run_freecad("freecad_robot.py", folder.path() / "seampath.dat");
    const auto rows = rows_of(ran.out, "flange ");
    std::size_t row = 0;
    for (const Waypoint& w : planned.waypoints) {
        if (w.kind != WaypointKind::approach && w.kind != WaypointKind::air) {
            continue;
        }
        ASSERT_LT(row, rows.size()) << ran.out;
        const std::vector<double>& n = rows[row++];
        ASSERT_EQ(n.size(), 7u);
        const Eigen::Isometry3d flange =
            cell.base_from_scan * (Eigen::Translation3d(w.p) * w.q) * cell.flange_from_tool.inverse();
        EXPECT_LT((Eigen::Vector3d(n[0], n[1], n[2]) - flange.translation()).norm(), 0.005);
        const Eigen::Quaterniond q(n[6], n[3], n[4], n[5]);
        EXPECT_LT(rotation_angle(q, Eigen::Quaterniond(flange.linear())), 4e-4 * kDeg);
    }
    EXPECT_EQ(row, rows.size());
    EXPECT_GE(row, 2u);
}

}  // namespace clients_test
}  // namespace seampath
