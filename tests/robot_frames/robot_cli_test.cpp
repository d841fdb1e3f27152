#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "datasets/fixtures/robot_scenes.hpp"
#include "pipeline/camera_json.hpp"
#include "stages/geometry/pose.hpp"
#include "stages/text.hpp"
#include "tests/cli/spawn.hpp"

/// `calibrate tcp` and `hand-eye` as a user calls them.
namespace seampath {
namespace robot_cli_test {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using Json = nlohmann::ordered_json;

std::string row(std::initializer_list<double> values) {
    std::string text;
    for (const double v : values) {
        text += (text.empty() ? "" : ",") + shortest(v);
    }
    return text + "\n";
}

std::string quaternion_table(const std::vector<FlangePose>& poses) {
    std::string text = "x_mm,y_mm,z_mm,qw,qx,qy,qz\n";
    for (const FlangePose& pose : poses) {
        const Eigen::Vector3d p = pose.base_from_flange.translation();
        const Eigen::Quaterniond q(pose.base_from_flange.linear());
        text += row({p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()});
    }
    return text;
}

class RobotCli : public testing::Test {
protected:
    TestFolder folder;
    fs::path out = folder.path() / "out";
    const TipPoses tips = make_tip_poses({}, 1);

    fs::path write(const std::string& name, const std::string& text) const {
        std::ofstream(folder.path() / name) << text;
        return folder.path() / name;
    }
    Outcome calibrate(const std::string& method, const fs::path& file,
                      const std::vector<std::string>& more = {}) const {
        std::vector<std::string> words{"calibrate", method, file, "--out", out, "--date", "2026-11-26T05:00:00Z"};
        words.insert(words.end(), more.begin(), more.end());
        return seampath_program(words);
    }
    Json result(const char* name = "result.json") const { return Json::parse(text_of(out / name)); }
    std::string error(const std::string& method, const std::string& name, const std::string& text) const {
        const Outcome run = calibrate(method, write(name, text));
        EXPECT_EQ(run.status, 2) << run.err;
        EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
        return run.err;
    }
};

TEST_F(RobotCli, TcpWritesResultAndHistory) {
    const Outcome run = calibrate("tcp", write("torch.csv", quaternion_table(tips.poses)), {"--limit", "0.5"});
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_THAT(run.out, AllOf(HasSubstr("torch: pass"), HasSubstr("flange_from_tool"), HasSubstr("pose 15")));
    const Json json = result();
    const auto p = json.at("flange_from_tool").at("position_mm").get<std::vector<double>>();
    const Eigen::Vector3d truth = tips.truth.frame.translation();
    EXPECT_LT((Eigen::Vector3d(p[0], p[1], p[2]) - truth).norm(), json.at("expanded_uncertainty_mm").get<double>());
    EXPECT_EQ(json.at("inputs")[0].at("sha256").get<std::string>().size(), 64u);
    EXPECT_THAT(seampath_program({"calibrate", "history", out}).out, AllOf(HasSubstr("torch"), HasSubstr("tcp")));
}

// The same poses as controllers of four makers write them.
TEST_F(RobotCli, RotationsOfEveryRobotGiveTheSameTip) {
    std::string ur = "x_m,y_m,z_m,rx_rad,ry_rad,rz_rad\n", kuka = "x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\n";
    std::string fanuc = "x_mm,y_mm,z_mm,w_deg,p_deg,r_deg\n";
    for (const FlangePose& pose : tips.poses) {
        const Eigen::Vector3d p = pose.base_from_flange.translation();
        const Eigen::Quaterniond q(pose.base_from_flange.linear());
        const Eigen::Vector3d v = rotation_vector(q), e = euler_zyx(q) * 180 / EIGEN_PI;
        ur += row({p.x() / 1000, p.y() / 1000, p.z() / 1000, v.x(), v.y(), v.z()});
        kuka += row({p.x(), p.y(), p.z(), e.x(), e.y(), e.z()});
        fanuc += row({p.x(), p.y(), p.z(), e.z(), e.y(), e.x()});
    }
    std::vector<std::vector<double>> found;
    for (const std::string& table : {quaternion_table(tips.poses), ur, kuka, fanuc}) {
        calibrate("tcp", write("tool.csv", table));
        found.push_back(result().at("flange_from_tool").at("position_mm").get<std::vector<double>>());
        for (std::size_t i = 0; i < 3; ++i) {
            EXPECT_NEAR(found.back()[i], found.front()[i], 1e-6);
        }
    }
}

TEST_F(RobotCli, AnAcceptedTipStaysUntilAReasonIsGiven) {
    EXPECT_EQ(calibrate("tcp", write("t.csv", quaternion_table(tips.poses)), {"--accept", "--reason", "new"}).status,
              0);
    auto bent = tips.poses;
    for (FlangePose& pose : bent) {
        pose.base_from_flange = pose.base_from_flange * Eigen::Translation3d(0, 0, 0.8);
    }
    const Outcome run = calibrate("tcp", write("t.csv", quaternion_table(bent)));
    EXPECT_EQ(run.status, 1);
    EXPECT_THAT(run.out, HasSubstr("the work point has moved by 0.800 mm"));
    EXPECT_EQ(result().at("change"), nullptr);
    EXPECT_NEAR(result("candidate.json").at("change").at("shift_mm")[2].get<double>(), -0.8, 1e-6);
    EXPECT_EQ(calibrate("tcp", folder.path() / "t.csv", {"--accept", "--reason", "bent"}).status, 0);
    EXPECT_FALSE(fs::exists(out / "candidate.json"));
    EXPECT_THAT(error("tcp", "other.csv", quaternion_table(tips.poses)), HasSubstr("give each a folder of its own"));
}

TEST_F(RobotCli, HandEyeOfCameraAndProfiler) {
    const BoardPoses boards = make_board_poses({}, 1);
    Json poses = Json::array();
    for (const BoardPose& pose : boards.poses) {
        poses.push_back({{"base_from_flange", pose_numbers(pose.flange.base_from_flange)},
                         {"camera_from_board", pose_numbers(pose.camera_from_board)}});
    }
    const Json camera{{"name", "eye"}, {"sensor", "camera"}, {"mount", "on-arm"}, {"poses", poses}};
    const Outcome run = calibrate("hand-eye", write("eye.json", camera.dump()));
    EXPECT_EQ(run.status, 0) << run.err << run.out;
    const auto p = result().at("flange_from_camera").at("position_mm").get<std::vector<double>>();
    EXPECT_LT((Eigen::Vector3d(p[0], p[1], p[2]) - boards.truth.frame.translation()).norm(), 0.5);

    const BallProfiles sections = make_ball_profiles({}, {}, 1);
    poses = Json::array();
    for (const BallProfile& profile : sections.profiles) {
        Json points = Json::array();
        for (const Eigen::Vector2d& q : profile.points) {
            points.push_back({q.x(), q.y()});
        }
        poses.push_back({{"base_from_flange", pose_numbers(profile.flange.base_from_flange)}, {"points_mm", points}});
    }
    out = folder.path() / "profiler";
    const Json profiler{
        {"name", "line"}, {"sensor", "profiler"}, {"mount", "on-arm"}, {"ball_diameter_mm", 25.4}, {"poses", poses}};
    EXPECT_EQ(calibrate("hand-eye", write("line.json", profiler.dump())).status, 0);
    const auto q = result().at("flange_from_profiler").at("position_mm").get<std::vector<double>>();
    EXPECT_LT((Eigen::Vector3d(q[0], q[1], q[2]) - sections.truth.frame.translation()).norm(), 0.4);
}

TEST_F(RobotCli, BadInputIsOneClearLineEach) {
    EXPECT_THAT(error("tcp", "a.csv", "x_mm,y_mm,z_mm,qw,qx,qy,qz\n1,2,3,1,0,0,0\n"),
                HasSubstr("tcp: 1 poses are too few"));
    EXPECT_THAT(error("tcp", "a.csv", "x,y,z,qw,qx,qy,qz\n1,2,3,1,0,0,0\n"),
                HasSubstr("its header does not say what the poses are"));
    EXPECT_THAT(error("tcp", "a.csv", "x_mm,y_mm,z_mm,qw,qx,qy,qz\n1,2,3,0,0,0,0.5\n"),
                HasSubstr("line 2: the quaternion qw, qx, qy, qz has the length 0.5"));
    EXPECT_THAT(error("tcp", "a.json", R"({"name": "a", "poses": [], "limit": 1})"),
                HasSubstr("/limit: there is no such key; did you mean \"limit_mm\"?"));
    EXPECT_THAT(error("hand-eye", "b.json", R"({"name": "b", "sensor": "camra", "mount": "on-arm", "poses": []})"),
                HasSubstr("did you mean \"camera\"?"));
    EXPECT_THAT(error("hand-eye", "b.json", R"({"name": "b", "sensor": "profiler", "mount": "on-arm", "poses": []})"),
                HasSubstr("/ball_diameter_mm: is missing"));
    EXPECT_THAT(error("hand-eye", "b.json", "[]"), HasSubstr("an object was needed"));
    EXPECT_EQ(calibrate("tcp", write("t.csv", quaternion_table(tips.poses)), {"--accept"}).status, 2);
    std::string still = "x_mm,y_mm,z_mm,qw,qx,qy,qz\n";
    for (int i = 0; i < 6; ++i) {
        still += "1,2,3,1,0,0,0\n";
    }
    EXPECT_THAT(error("tcp", "a.csv", still), HasSubstr("the poses do not turn"));
}

}  // namespace robot_cli_test
}  // namespace seampath
