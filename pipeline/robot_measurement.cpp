#include <set>

#include "pipeline/camera_json.hpp"
#include "pipeline/json_text.hpp"
#include "pipeline/optics_files.hpp"
#include "pipeline/robot_calibration.hpp"
#include "pipeline/text.hpp"
#include "stages/angle.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using Json = JsonObject::Json;
using Complaints = std::vector<std::string>;

constexpr std::size_t kMostRobotBytes = std::size_t{64} << 20;

void take_options(const JsonObject& root, RobotFrameOptions& options) {
    options.limit_mm = root.positive("limit_mm", options.limit_mm);
    if (!root.has("noise")) {
        return;
    }
    const JsonObject object(root.member("noise"), root.place_of("noise"), root.problems(),
                            {"robot_mm", "robot_deg", "sensor_mm", "sensor_deg"});
    PoseNoise& noise = options.noise;
    noise.robot_mm = object.positive("robot_mm", noise.robot_mm);
    noise.robot_rad = kDegree * object.positive("robot_deg", noise.robot_rad / kDegree);
    noise.sensor_mm = object.positive("sensor_mm", noise.sensor_mm);
    noise.sensor_rad = kDegree * object.positive("sensor_deg", noise.sensor_rad / kDegree);
}

FlangePose flange_of(const JsonObject& object, std::size_t index) {
    const std::string name = object.has("name") ? object.text("name") : "pose " + std::to_string(index + 1);
    return {name, pose_from(object, "base_from_flange")};
}

std::vector<Vector2d> points_of(const JsonObject& object) {
    std::vector<Vector2d> points;
    const Json& list = object.member("points_mm");
    if (object.has("points_mm") && !list.is_array()) {
        object.complain("points_mm", "a list of points [x, z] was needed");
    }
    for (std::size_t i = 0; list.is_array() && i < list.size(); ++i) {
        const auto p = object.numbers_of(list[i], "points_mm/" + std::to_string(i), 2);
        if (p.size() == 2) {
            points.emplace_back(p[0], p[1]);
        }
    }
    return points;
}

/// Calls f(object, flange) for every pose; a name that stands twice is a problem.
template <class F>
void for_poses(const JsonObject& root, const std::vector<std::string_view>& keys, const F& f) {
    const Json& list = root.member("poses");
    if (root.has("poses") && !list.is_array()) {
        root.complain("poses", "a list of poses was needed");
    }
    std::set<std::string> names;
    for (std::size_t i = 0; list.is_array() && i < list.size(); ++i) {
        const JsonObject object(list[i], "/poses/" + std::to_string(i), root.problems(), keys);
        const FlangePose flange = flange_of(object, i);
        if (!names.insert(flange.name).second) {
            object.complain("name", "\"" + flange.name + "\" stands twice");
        }
        f(object, flange);
    }
}

RobotMeasurement tcp_from(const Json& json, Complaints& problems) {
    const JsonObject root(json, "", problems, {"name", "limit_mm", "poses"});
    RobotMeasurement m;
    m.name = root.text("name");
    take_options(root, m.options);
    for_poses(root, {"name", "base_from_flange"},
              [&](const JsonObject&, const FlangePose& flange) { m.tips.push_back(flange); });
    return m;
}

/// Pictures in the place of the board's poses.
struct BoardPictures {
    Json camera;
    Board board;
    std::vector<std::string> names;
};

BoardPictures pictures_from(const JsonObject& root, RobotMeasurement& m) {
    BoardPictures pictures{root.member("camera"), board_from(root.member("board"), "/board", root.problems()), {}};
    check_camera(pictures.camera, root.problems());
    for_poses(root, {"name", "base_from_flange", "image"}, [&](const JsonObject& object, const FlangePose& flange) {
        m.boards.push_back({flange, {}});
        pictures.names.push_back(object.text("image"));
    });
    return pictures;
}

RobotMeasurement hand_eye_from(const Json& json, BoardPictures& pictures, Complaints& problems) {
    constexpr std::array<std::string_view, 2> kSensors{"camera", "profiler"};
    constexpr std::array<std::string_view, 2> kMounts{"on-arm", "beside-arm"};
    const JsonObject root(
        json, "", problems,
        {"name", "sensor", "mount", "limit_mm", "noise", "ball_diameter_mm", "camera", "board", "poses"});
    RobotMeasurement m;
    m.name = root.text("name");
    m.method = root.word("sensor", kSensors) == 0 ? RobotMethod::camera : RobotMethod::profiler;
    m.mount = static_cast<SensorMount>(root.word("mount", kMounts));
    take_options(root, m.options);
    if (m.method == RobotMethod::camera && (root.has("board") || root.has("camera"))) {
        pictures = pictures_from(root, m);
        return m;
    }
    if (m.method == RobotMethod::camera) {
        for_poses(root, {"name", "base_from_flange", "camera_from_board"},
                  [&](const JsonObject& object, const FlangePose& flange) {
                      m.boards.push_back({flange, pose_from(object, "camera_from_board")});
                  });
        return m;
    }
    root.member("ball_diameter_mm");
    m.ball_diameter_mm = root.positive("ball_diameter_mm", 0);
    for_poses(root, {"name", "base_from_flange", "points_mm"}, [&](const JsonObject& object, const FlangePose& flange) {
        m.profiles.push_back({flange, points_of(object)});
    });
    return m;
}

}  // namespace

RobotMeasurement read_tcp_poses(const fs::path& file) {
    RobotMeasurement m;
    read_json_file(file, kMostRobotBytes, "tcp", "a file with poses of the flange was needed",
                   [&](const Json& root, Complaints& problems) { m = tcp_from(root, problems); });
    return m;
}

RobotMeasurement read_hand_eye(const fs::path& file) {
    RobotMeasurement m;
    BoardPictures pictures;
    read_json_file(file, kMostRobotBytes, "hand-eye", "a file with poses and what was seen in them was needed",
                   [&](const Json& root, Complaints& problems) { m = hand_eye_from(root, pictures, problems); });
    if (!pictures.names.empty()) {
        const CameraModel camera = camera_or_result(pictures.camera, file.parent_path());
        for (std::size_t i = 0; i < m.boards.size(); ++i) {
            const fs::path picture = file.parent_path() / pictures.names[i];
            m.boards[i].camera_from_board =
                locate_in_picture(picture, camera, pictures.board, m.pictures).camera_from_board;
        }
    }
    return m;
}

}  // namespace seampath
