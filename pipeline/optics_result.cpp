#include <nlohmann/json.hpp>

#include "pipeline/camera_json.hpp"
#include "pipeline/files.hpp"
#include "pipeline/json_text.hpp"
#include "pipeline/json_values.hpp"
#include "pipeline/optics_files.hpp"
#include "pipeline/text.hpp"
#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

using Json = nlohmann::ordered_json;
using TextRows = std::vector<std::vector<std::string>>;

constexpr const char* kCameraKind = "camera calibration";
constexpr const char* kLaserKind = "laser calibration";
constexpr std::size_t kMostCameraBytes = std::size_t{16} << 20;
constexpr std::array<const char*, kCameraNumbers> kNumberNames{"fx_px", "fy_px", "cx_px", "cy_px", "k1",
                                                               "k2",    "p1",    "p2",    "k3"};

Json inputs_json(const std::vector<InputFile>& inputs) {
    Json list = Json::array();
    for (const InputFile& input : inputs) {
        list.push_back({{"file", input.file}, {"sha256", input.sha256}});
    }
    return list;
}

template <class Result>
Json head_json(const char* kind, const std::string& name, const std::string& date, const Result& r) {
    return {{"kind", kind},
            {"name", name},
            {"date", date},
            {"program", "seampath " SEAMPATH_VERSION},
            {"verdict", r.pass() ? "pass" : "fail"},
            {"faults", r.faults},
            {"notes", r.notes}};
}

template <class Result>
std::string head_text(const std::string& name, const Result& r) {
    std::string text = name + ": " + (r.pass() ? "pass" : "fail") + "\n";
    for (const auto& fault : r.faults) {
        text += "  " + fault + "\n";
    }
    for (const auto& note : r.notes) {
        text += "  note: " + note + "\n";
    }
    return text + "\n";
}

std::string written(const Json& json) {
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json map_json(const CameraCalibration& r) {
    Json rows = Json::array();
    for (std::size_t row = 0; row < CameraCalibration::kMapRows; ++row) {
        Json cells = Json::array();
        for (std::size_t column = 0; column < CameraCalibration::kMapColumns; ++column) {
            const ResidualCell& c = r.map[row * CameraCalibration::kMapColumns + column];
            cells.push_back({{"points", c.points}, {"mean_px", {c.mean_px.x(), c.mean_px.y()}}, {"rms_px", c.rms_px}});
        }
        rows.push_back(std::move(cells));
    }
    return rows;
}

std::array<double, kCameraNumbers> camera_numbers(const CameraModel& c) {
    return {c.focal_px.x(),  c.focal_px.y(),  c.centre_px.x(), c.centre_px.y(), c.distortion[0],
            c.distortion[1], c.distortion[2], c.distortion[3], c.distortion[4]};
}

}  // namespace

std::string camera_result_json(const CameraRun& run) {
    const CameraCalibration& r = run.result;
    Json json = head_json(kCameraKind, run.name, run.date, r);
    json["camera"] = camera_json(r.camera);
    Json sigma;
    for (std::size_t i = 0; i < kNumberNames.size(); ++i) {
        const auto k = static_cast<Eigen::Index>(i);
        sigma[kNumberNames[i]] = std::sqrt(r.covariance(k, k));
    }
    json["sigma"] = std::move(sigma);
    json["covariance"] = {{"order", kNumberNames}, {"values", matrix_json(r.covariance)}};
    json["rms_px"] = r.rms_px;
    json["held_out_px"] = r.held_out_px;
    json["sigma_of_a_point_px"] = r.sigma_px;
    Json views = Json::array();
    for (const ViewResult& v : r.views) {
        views.push_back({{"image", v.name},
                         {"points", v.points},
                         {"dropped", v.dropped},
                         {"rms_px", v.rms_px},
                         {"held_out_px", v.held_out_px},
                         {"tilt_deg", v.tilt_rad / kDegree},
                         {"camera_from_board", pose_numbers(v.camera_from_board)}});
    }
    json["views"] = std::move(views);
    json["without_board"] = run.without_board;
    json["residual_map"] = map_json(r);
    json["inputs"] = inputs_json(run.inputs);
    return written(json);
}

CameraModel read_camera_result(const std::filesystem::path& file) {
    Json root;
    std::vector<std::string> problems;
    try {
        root = parse_json(read_file(file, kMostCameraBytes, "camera"));
    } catch (const JsonError& error) {
        throw InputError("camera: " + file.string() + ": " + error.what());
    }
    if (!root.is_object() || root.value("kind", Json()) != kCameraKind) {
        throw InputError("camera: " + file.string() +
                         " is no result of a camera's calibration; one that \"seampath calibrate camera\" wrote was "
                         "needed");
    }
    if (root.value("verdict", Json()) != "pass") {
        throw InputError("camera: the calibration " + file.string() + " did not pass; calibrate the camera again");
    }
    CameraModel camera = camera_from(root.value("camera", Json()), "/camera", problems);
    if (!problems.empty()) {
        throw InputError("camera: " + file.string() + ": " + problems.front());
    }
    return camera;
}

std::string camera_result_text(const CameraRun& run) {
    const CameraCalibration& r = run.result;
    const auto numbers = camera_numbers(r.camera);
    TextRows rows{{"number", "value", "1-sigma"}};
    for (std::size_t i = 0; i < kNumberNames.size(); ++i) {
        const auto k = static_cast<Eigen::Index>(i);
        const int decimals = i < 4 ? 4 : 7;
        rows.push_back({kNumberNames[i], fixed(numbers[i], decimals), fixed(std::sqrt(r.covariance(k, k)), decimals)});
    }
    std::string text = head_text(run.name, r) + aligned(rows) + "\nresiduals " + fixed(r.rms_px, 3) +
                       " px rms, in views held out " + fixed(r.held_out_px, 3) + " px\n\n";
    rows = {{"view", "points", "rms px", "held out px", "tilt deg"}};
    for (const ViewResult& v : r.views) {
        rows.push_back({v.name, std::to_string(v.points), fixed(v.rms_px, 3), fixed(v.held_out_px, 3),
                        fixed(v.tilt_rad / kDegree, 1)});
    }
    text += aligned(rows);
    for (const std::string& name : run.without_board) {
        text += name + ": the board was not found\n";
    }
    return text;
}

std::string laser_result_json(const LaserRun& run) {
    const LaserCalibration& r = run.result;
    Json json = head_json(kLaserKind, run.name, run.date, r);
    json["camera"] = camera_json(run.camera);
    json["laser_plane"] = plane_json(laser_plane_of(r.plane));
    json["covariance"] = {{"order", {"turn_u_rad", "turn_v_rad", "shift_mm"}},
                          {"point_mm", vector_json(r.plane.point)},
                          {"u", vector_json(r.u)},
                          {"v", vector_json(r.v)},
                          {"values", matrix_json(r.covariance)}};
    json["expanded_uncertainty_mm"] = r.expanded_mm;
    json["nearest_mm"] = r.nearest_mm;
    json["furthest_mm"] = r.furthest_mm;
    json["rms_mm"] = r.rms_mm;
    Json views = Json::array();
    for (const LitViewResult& v : r.views) {
        views.push_back(
            {{"image", v.name}, {"points", v.points}, {"rms_mm", v.rms_mm}, {"held_out_mm", v.held_out_mm}});
    }
    json["views"] = std::move(views);
    json["inputs"] = inputs_json(run.inputs);
    return written(json);
}

std::string laser_result_text(const LaserRun& run) {
    const LaserCalibration& r = run.result;
    const LaserPlane plane = laser_plane_of(r.plane);
    std::string text = head_text(run.name, r) + "normal " + fixed(plane.normal.x(), 6) + " " +
                       fixed(plane.normal.y(), 6) + " " + fixed(plane.normal.z(), 6) + ", distance " +
                       fixed(plane.distance_mm, 4) + " mm\nexpanded uncertainty " + fixed(r.expanded_mm, 4) +
                       " mm at depths of " + fixed(r.nearest_mm, 1) + " to " + fixed(r.furthest_mm, 1) + " mm\n\n";
    TextRows rows{{"view", "points", "rms mm", "held out mm"}};
    for (const LitViewResult& v : r.views) {
        rows.push_back({v.name, std::to_string(v.points), fixed(v.rms_mm, 4), fixed(v.held_out_mm, 4)});
    }
    return text + aligned(rows);
}

}  // namespace seampath
