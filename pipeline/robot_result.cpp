#include <nlohmann/json.hpp>

#include "pipeline/files.hpp"
#include "pipeline/json_text.hpp"
#include "pipeline/json_values.hpp"
#include "pipeline/robot_calibration.hpp"
#include "pipeline/text.hpp"
#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMostResultBytes = std::size_t{16} << 20;
constexpr const char* kRobotKind = "robot calibration";

/// What the frame and the target are called, by the method and where the sensor is.
struct FrameNames {
    std::string frame, target, of;  ///< "flange_from_camera", "base_from_board", "flange"
};

FrameNames names_of(const RobotMeasurement& m) {
    const bool on_arm = m.mount == SensorMount::on_arm;
    const std::string near = on_arm ? "flange" : "base", far = on_arm ? "base" : "flange";
    switch (m.method) {
        case RobotMethod::tcp:
            return {"flange_from_tool", "base_from_pivot", "flange"};
        case RobotMethod::camera:
            return {near + "_from_camera", far + "_from_board", near};
        case RobotMethod::profiler:
            return {near + "_from_profiler", far + "_from_ball", near};
    }
    throw InternalError("every method has names");
}

Json pose_rows(const RobotFrame& f) {
    Json list = Json::array();
    for (const PoseResult& pose : f.poses) {
        list.push_back({{"name", pose.name},
                        {"residual_mm", pose.residual_mm},
                        {"residual_deg", pose.residual_rad / kDegree},
                        {"without_mm", pose.without_mm},
                        {"p_value", pose.p_value},
                        {"left_out", pose.left_out}});
    }
    return list;
}

Json robot_change_json(const RobotCalibration& c) {
    if (!c.change) {
        return nullptr;
    }
    const Vector6& d = c.change->step;
    return {{"since", c.change->since},
            {"shift_mm", vector_json(d.head<3>())},
            {"turn_deg", vector_json(d.tail<3>() / kDegree)},
            {"work_point_mm", c.change->work_point_mm.front()},
            {"limit_mm", c.change->limit_mm}};
}

}  // namespace

std::string robot_result_json(const RobotCalibration& c) {
    const RobotFrame& f = c.frame;
    const FrameNames names = names_of(c.measured);
    Json accepted, inputs = Json::array();
    if (c.accepted) {
        accepted = {{"date", c.accepted->date}, {"reason", c.accepted->reason}};
    }
    for (const InputFile& input : c.inputs) {
        inputs.push_back({{"file", input.file}, {"sha256", input.sha256}});
    }
    const PoseNoise& noise = c.measured.options.noise;
    const Json json{{"kind", kRobotKind},
                    {"name", c.measured.name},
                    {"method", history_row(c).method},
                    {"date", c.date},
                    {"program", "seampath " SEAMPATH_VERSION},
                    {"verdict", f.pass() ? "pass" : "fail"},
                    {"faults", f.faults},
                    {"notes", f.notes},
                    {"frame", names.frame},
                    {names.frame, pose_json(f.frame)},
                    {"covariance",
                     {{"order", {"x_mm", "y_mm", "z_mm", "rx_rad", "ry_rad", "rz_rad"}},
                      {"meaning", "shift of the frame's origin and turn about it, along the axes of the " + names.of},
                      {"values", matrix_json(f.covariance)}}},
                    {"sigma_mm", vector_json(f.covariance.diagonal().head<3>().cwiseSqrt())},
                    {"sigma_deg", vector_json(f.covariance.diagonal().tail<3>().cwiseSqrt() / kDegree)},
                    {names.target, pose_json(f.target)},
                    {"work_point_mm", vector_json(f.work_point)},
                    {"expanded_uncertainty_mm", f.expanded_mm},
                    {"limit_mm", c.measured.options.limit_mm},
                    {"weakest_direction", vector_json(f.weakest)},
                    {"weakest_sigma_mm", f.weakest_mm},
                    {"residual_mm", f.residual_mm},
                    {"residual_deg", f.residual_rad / kDegree},
                    {"largest_residual_mm", f.largest_mm},
                    {"residuals_over_noise_given", f.sigma_ratio},
                    {"noise",
                     {{"robot_mm", noise.robot_mm},
                      {"robot_deg", noise.robot_rad / kDegree},
                      {"sensor_mm", noise.sensor_mm},
                      {"sensor_deg", noise.sensor_rad / kDegree}}},
                    {"redundancy", f.redundancy},
                    {"poses", pose_rows(f)},
                    {"change", robot_change_json(c)},
                    {"accepted", std::move(accepted)},
                    {"inputs", std::move(inputs)}};
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::optional<StoredRobotFrame> accepted_robot_frame(const std::filesystem::path& file) {
    if (!std::filesystem::exists(file)) {
        return std::nullopt;
    }
    try {
        const Json json = parse_json(read_file(file, kMostResultBytes, "calibrate"));
        if (json.at("kind") != kRobotKind) {
            throw InputError("its kind is " + json_excerpt(json.at("kind")));
        }
        if (json.at("accepted").is_null()) {
            return std::nullopt;
        }
        StoredRobotFrame s{json.at("name").get<std::string>(),
                           json.at("method").get<std::string>(),
                           json.at("date").get<std::string>(),
                           {}};
        s.frame.matrix() = matrix_of(json.at(json.at("frame").get<std::string>()).at("matrix"), 4);
        return s;
    } catch (const std::exception& error) {
        throw InputError("calibrate: " + file.string() +
                         " is no result of a robot's calibration; give --out a folder of its own (" +
                         std::string(error.what()) + ")");
    }
}

std::string robot_result_text(const RobotCalibration& c) {
    const RobotFrame& f = c.frame;
    const Vector3d p = f.frame.translation(), sigma = f.covariance.diagonal().head<3>().cwiseSqrt();
    const Eigen::Quaterniond q(f.frame.linear());
    std::string text = c.measured.name + ": " + (f.pass() ? "pass" : "fail") + "\n";
    for (const auto& fault : f.faults) {
        text += "  " + fault + "\n";
    }
    for (const auto& note : f.notes) {
        text += "  note: " + note + "\n";
    }
    text += "\n" + names_of(c.measured).frame + ", mm and quaternion w x y z:\n  " + fixed(p.x(), 4) + " " +
            fixed(p.y(), 4) + " " + fixed(p.z(), 4) + "   " + fixed(q.w(), 8) + " " + fixed(q.x(), 8) + " " +
            fixed(q.y(), 8) + " " + fixed(q.z(), 8) + "\n  1-sigma " + fixed(sigma.x(), 4) + " " + fixed(sigma.y(), 4) +
            " " + fixed(sigma.z(), 4) + " mm; expanded uncertainty at the work point " + fixed(f.expanded_mm, 4) +
            " mm" + (c.change ? "; moved by " + fixed(c.change->work_point_mm.front(), 4) + " mm" : "") + "\n\n";
    std::vector<std::vector<std::string>> rows{{"pose", "residual mm", "deg", "without it mm", "p", "left out"}};
    for (const PoseResult& pose : f.poses) {
        rows.push_back({pose.name, fixed(pose.residual_mm, 4), fixed(pose.residual_rad / kDegree, 4),
                        fixed(pose.without_mm, 4), fixed(pose.p_value, 4), pose.left_out ? "yes" : ""});
    }
    return text + aligned(rows);
}

}  // namespace seampath
