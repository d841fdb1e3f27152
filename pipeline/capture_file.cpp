#include "pipeline/capture_file.hpp"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "pipeline/files.hpp"
#include "pipeline/json_text.hpp"
#include "pipeline/text.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxCaptureBytes = std::size_t{64} << 20;  // some 300000 frames
constexpr double kLargestNumber = 1e9;                           // mm, px: their squares keep all digits
constexpr double kLeastPlaneDistance = 1;                        // mm from the camera; sensors have at least tens

/// One object of the file with its place in it, e.g. "/camera". Collects what is wrong in `problems`.
class CaptureObject {
public:
    CaptureObject(const Json& value, std::string place, std::vector<std::string>& problems,
                  std::vector<std::string_view> keys)
        : value_(value), place_(std::move(place)), problems_(problems) {
        if (value.is_null()) {
            return;  // every key of it will be missing
        }
        if (!value.is_object()) {
            complain("", "is " + json_excerpt(value) + "; an object was needed");
            return;
        }
        for (const auto& [key, given] : value.items()) {
            if (std::find(keys.begin(), keys.end(), key) == keys.end()) {
                complain(key, "there is no such key" + hint(key, keys));
            }
        }
    }

    bool has(const char* key) const { return value_.is_object() && value_.contains(key); }
    std::string place_of(const std::string& key) const { return place_ + "/" + key; }

    void complain(const std::string& key, const std::string& what) const {
        problems_.push_back((key.empty() ? (place_.empty() ? "/" : place_) : place_of(key)) + ": " + what);
    }

    /// Null, which is complained of, where the key is missing.
    const Json& member(const char* key) const {
        static const Json kNone;
        if (!has(key)) {
            complain(key, "is missing");
            return kNone;
        }
        return value_.at(key);
    }

    /// So many numbers; empty, which is complained of, for anything else.
    std::vector<double> numbers(const char* key, std::size_t count) const {
        return has(key) ? numbers_of(value_.at(key), key, count) : (member(key), std::vector<double>());
    }

    double number(const char* key) const {
        const Json& value = member(key);
        if (!has(key)) {
            return 0;
        }
        const auto all = numbers_of(Json::array({value}), key, 1);
        return all.empty() ? 0 : all[0];
    }

    std::string text(const char* key) const {
        const Json& value = member(key);
        if (has(key) && !value.is_string()) {
            complain(key, json_excerpt(value) + " is no text");
        }
        return value.is_string() ? value.get<std::string>() : std::string();
    }

    std::vector<double> numbers_of(const Json& value, const std::string& key, std::size_t count) const {
        std::vector<double> all;
        const bool list = value.is_array() && value.size() == count;
        for (std::size_t i = 0; list && i < count; ++i) {
            if (value[i].is_number() && std::abs(value[i].get<double>()) <= kLargestNumber) {
                all.push_back(value[i].get<double>());
            }
        }
        if (all.size() != count) {
            complain(key, json_excerpt(value) + " is not " +
                              (count == 1 ? "a number" : std::to_string(count) + " numbers") + " of at most 1e9");
            return {};
        }
        return all;
    }

private:
    const Json& value_;
    std::string place_;
    std::vector<std::string>& problems_;
};

Isometry3d pose_from(const CaptureObject& object, const char* key) {
    constexpr double kUnitTolerance = 1e-3;
    Isometry3d pose = Isometry3d::Identity();
    const std::vector<double> v = object.numbers(key, 7);
    if (v.empty()) {
        return pose;
    }
    const Eigen::Quaterniond q(v[3], v[4], v[5], v[6]);
    if (std::abs(q.norm() - 1) > kUnitTolerance) {
        object.complain(key, "its quaternion w, x, y, z has the length " + shortest(q.norm()) + "; 1 was needed");
        return pose;
    }
    pose.translation() = Vector3d(v[0], v[1], v[2]);
    pose.linear() = q.normalized().toRotationMatrix();
    return pose;
}

CameraModel camera_from(const Json& value, std::vector<std::string>& problems) {
    constexpr double kMostPixels = 32768;
    CameraModel camera;
    const CaptureObject object(value, "/camera", problems, {"size_px", "matrix_px", "distortion"});
    const auto size = object.numbers("size_px", 2);
    const auto whole = [](double v) { return v >= 1 && v <= kMostPixels && v == std::floor(v); };
    if (!size.empty() && whole(size[0]) && whole(size[1])) {
        camera.width = static_cast<int>(size[0]);
        camera.height = static_cast<int>(size[1]);
    } else if (!size.empty()) {
        object.complain("size_px", "is " + shortest(size[0]) + " x " + shortest(size[1]) +
                                       "; whole numbers of pixels from 1 to 32768 were needed");
    }
    const Json& matrix = object.member("matrix_px");
    std::vector<double> m;
    for (std::size_t row = 0; matrix.is_array() && row < matrix.size(); ++row) {
        const auto numbers = object.numbers_of(matrix[row], "matrix_px/" + std::to_string(row), 3);
        m.insert(m.end(), numbers.begin(), numbers.end());
    }
    if (m.size() == 9 && m[0] > 0 && m[4] > 0 && m[1] == 0 && m[3] == 0 && m[6] == 0 && m[7] == 0 && m[8] == 1) {
        camera.focal_px = {m[0], m[4]};
        camera.centre_px = {m[2], m[5]};
    } else if (object.has("matrix_px")) {
        object.complain("matrix_px", "[[fx, 0, cx], [0, fy, cy], [0, 0, 1]] with focal lengths above 0 was needed");
    }
    if (object.has("distortion")) {
        const auto d = object.numbers("distortion", 5);
        std::copy(d.begin(), d.end(), camera.distortion.begin());
    }
    return camera;
}

LaserPlane plane_from(const Json& value, std::vector<std::string>& problems) {
    LaserPlane plane;
    const CaptureObject object(value, "/laser_plane", problems, {"normal", "distance_mm"});
    const auto n = object.numbers("normal", 3);
    plane.distance_mm = object.number("distance_mm");
    if (!n.empty()) {
        const Vector3d normal(n[0], n[1], n[2]);
        if (normal.norm() < 1e-9) {
            object.complain("normal", "has no direction; a vector across the laser's plane was needed");
            return plane;
        }
        plane.normal = normal.normalized();
        plane.distance_mm /= normal.norm();
    }
    if (object.has("distance_mm") && !(std::abs(plane.distance_mm) >= kLeastPlaneDistance)) {
        object.complain("distance_mm", "the laser's plane passes the camera at " + fixed(plane.distance_mm, 3) +
                                           " mm, so that a picture shows no heights; 1 mm or more was needed; "
                                           "calibrate the laser again");
    }
    return plane;
}

/// The picture's path; one that isn't there is a problem.
fs::path image_from(const CaptureObject& object, const fs::path& folder) {
    const std::string name = object.text("image");
    fs::path image = folder / name;
    std::error_code ignored;
    if (!name.empty() && !fs::is_regular_file(image, ignored)) {
        object.complain("image", "there is no picture " + image.string());
    }
    return image;
}

StripeCapture stripe_capture(const Json& root, const fs::path& folder, std::vector<std::string>& problems) {
    const CaptureObject object(root, "", problems, {"kind", "camera", "laser_plane", "frames"});
    StripeCapture capture;
    capture.camera = camera_from(object.member("camera"), problems);
    capture.plane = plane_from(object.member("laser_plane"), problems);
    const Json& frames = object.member("frames");
    if (object.has("frames") && (!frames.is_array() || frames.empty())) {
        object.complain("frames", "a list with a picture and its pose each was needed");
    }
    // Pixels of the scan's raster are counted with 32 bits.
    if (frames.is_array() && frames.size() * static_cast<std::size_t>(capture.camera.width) > 0xffffffff) {
        object.complain("frames", "are too many for one scan: " + std::to_string(frames.size()) + " of " +
                                      std::to_string(capture.camera.width) + " columns; divide the capture");
        return capture;
    }
    for (std::size_t i = 0; frames.is_array() && i < frames.size(); ++i) {
        const CaptureObject frame(frames[i], "/frames/" + std::to_string(i), problems, {"image", "base_from_camera"});
        capture.images.push_back(image_from(frame, folder));
        capture.base_from_camera.push_back(pose_from(frame, "base_from_camera"));
    }
    return capture;
}

DepthCapture depth_capture(const Json& root, const fs::path& folder, std::vector<std::string>& problems) {
    const CaptureObject object(root, "", problems, {"kind", "camera", "image", "mm_per_unit", "base_from_camera"});
    DepthCapture capture;
    capture.camera = camera_from(object.member("camera"), problems);
    capture.image = image_from(object, folder);
    capture.mm_per_unit = object.number("mm_per_unit");
    if (object.has("mm_per_unit") && !(capture.mm_per_unit > 0)) {
        object.complain("mm_per_unit", shortest(capture.mm_per_unit) + " is not above 0");
    }
    if (object.has("base_from_camera")) {
        capture.base_from_camera = pose_from(object, "base_from_camera");
    }
    return capture;
}

PhotoCapture photo_capture(const Json& root, const fs::path& folder, std::vector<std::string>& problems) {
    const CaptureObject object(root, "", problems, {"kind", "camera", "image", "camera_from_plane"});
    PhotoCapture capture;
    capture.camera = camera_from(object.member("camera"), problems);
    capture.image = image_from(object, folder);
    capture.camera_from_plane = pose_from(object, "camera_from_plane");
    return capture;
}

}  // namespace

bool is_capture(const fs::path& file) {
    return file.extension() == ".json";
}

Capture read_capture(const fs::path& file) {
    const std::string text = read_file(file, kMaxCaptureBytes, "read");
    Json root;
    try {
        root = parse_json(text);
    } catch (const JsonError& error) {
        throw InputError("read: " + file.string() + ": " + error.what() + "; a capture file was expected");
    }
    const Json kind = root.is_object() ? root.value("kind", Json()) : Json();
    std::vector<std::string> problems;
    Capture capture;
    if (kind == "laser_stripe") {
        capture = stripe_capture(root, file.parent_path(), problems);
    } else if (kind == "depth") {
        capture = depth_capture(root, file.parent_path(), problems);
    } else if (kind == "photo") {
        capture = photo_capture(root, file.parent_path(), problems);
    } else {
        problems.push_back("/kind: " + (kind.is_null() ? "is missing" : json_excerpt(kind) + " is no kind of capture") +
                           "; \"laser_stripe\", \"depth\" or \"photo\" was needed");
    }
    std::string lines;
    for (const std::string& problem : problems) {
        lines += (lines.empty() ? "" : "\n") + file.string() + ": " + problem;
    }
    if (!lines.empty()) {
        throw InputError(lines);
    }
    return capture;
}

std::vector<fs::path> images_of(const Capture& capture) {
    if (const auto* stripes = std::get_if<StripeCapture>(&capture)) {
        return stripes->images;
    }
    const auto* depth = std::get_if<DepthCapture>(&capture);
    return {depth ? depth->image : std::get<PhotoCapture>(capture).image};
}

}  // namespace seampath
