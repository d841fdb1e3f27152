#include "pipeline/capture_file.hpp"

#include <nlohmann/json.hpp>

#include "pipeline/camera_json.hpp"
#include "pipeline/files.hpp"
#include "pipeline/json_object.hpp"
#include "pipeline/json_text.hpp"
#include "pipeline/text.hpp"
#include "stages/error.hpp"
#include "stages/text.hpp"

namespace seampath {
namespace {

namespace fs = std::filesystem;
using Eigen::Isometry3d;
using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxCaptureBytes = std::size_t{64} << 20;  // some 300000 frames

/// The picture's path; one that isn't there is a problem.
fs::path image_from(const JsonObject& object, const fs::path& folder) {
    const std::string name = object.text("image");
    fs::path image = folder / name;
    std::error_code ignored;
    if (!name.empty() && !fs::is_regular_file(image, ignored)) {
        object.complain("image", "there is no picture " + image.string());
    }
    return image;
}

StripeCapture stripe_capture(const Json& root, const fs::path& folder, std::vector<std::string>& problems) {
    const JsonObject object(root, "", problems, {"kind", "camera", "laser_plane", "frames"});
    StripeCapture capture;
    capture.camera = camera_from(object.member("camera"), "/camera", problems);
    capture.plane = plane_from(object.member("laser_plane"), "/laser_plane", problems);
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
        const JsonObject frame(frames[i], "/frames/" + std::to_string(i), problems, {"image", "base_from_camera"});
        capture.images.push_back(image_from(frame, folder));
        capture.base_from_camera.push_back(pose_from(frame, "base_from_camera"));
    }
    return capture;
}

DepthCapture depth_capture(const Json& root, const fs::path& folder, std::vector<std::string>& problems) {
    const JsonObject object(root, "", problems, {"kind", "camera", "image", "mm_per_unit", "base_from_camera"});
    DepthCapture capture;
    capture.camera = camera_from(object.member("camera"), "/camera", problems);
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

std::vector<BoardSight> plane_points_from(const JsonObject& object) {
    const Json& list = object.member("plane_points");
    if (!list.is_array() || list.size() < 4) {
        object.complain("plane_points", "a list of 4 or more points with pixel_px and plane_mm was needed");
        return {};
    }
    std::vector<BoardSight> points;
    for (std::size_t i = 0; i < list.size(); ++i) {
        const JsonObject point(list[i], "/plane_points/" + std::to_string(i), object.problems(),
                               {"pixel_px", "plane_mm"});
        const auto pixel = point.numbers("pixel_px", 2), on_plane = point.numbers("plane_mm", 2);
        if (!pixel.empty() && !on_plane.empty()) {
            points.push_back({{on_plane[0], on_plane[1]}, {pixel[0], pixel[1]}});
        }
    }
    return points;
}

PhotoCapture photo_capture(const Json& root, const fs::path& folder, std::vector<std::string>& problems) {
    const JsonObject object(root, "", problems, {"kind", "camera", "image", "camera_from_plane", "plane_points"});
    PhotoCapture capture;
    capture.camera = camera_from(object.member("camera"), "/camera", problems);
    capture.image = image_from(object, folder);
    if (!object.has("plane_points")) {
        capture.camera_from_plane = pose_from(object, "camera_from_plane");
        return capture;
    }
    if (object.has("camera_from_plane")) {
        object.complain("plane_points", "stand beside camera_from_plane; one of the two was needed");
    }
    capture.plane_points = {capture.image.string(), plane_points_from(object)};
    return capture;
}

}  // namespace

bool is_capture(const fs::path& file) {
    return file.extension() == ".json";
}

Capture read_capture(const fs::path& file) {
    Capture capture;
    const auto take = [&](const Json& root, std::vector<std::string>& problems) {
        const Json kind = root.is_object() ? root.value("kind", Json()) : Json();
        if (kind == "laser_stripe") {
            capture = stripe_capture(root, file.parent_path(), problems);
        } else if (kind == "depth") {
            capture = depth_capture(root, file.parent_path(), problems);
        } else if (kind == "photo") {
            capture = photo_capture(root, file.parent_path(), problems);
        } else {
            problems.push_back(
                "/kind: " + (kind.is_null() ? "is missing" : json_excerpt(kind) + " is no kind of capture") +
                "; \"laser_stripe\", \"depth\" or \"photo\" was needed");
        }
    };
    read_json_file(file, kMaxCaptureBytes, "read", "a capture file was expected", take);
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
