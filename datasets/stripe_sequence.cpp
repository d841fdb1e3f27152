#include "datasets/stripe_sequence.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

#include "datasets/picture_file.hpp"
#include "datasets/portable_math.hpp"
#include "datasets/rows.hpp"
#include "pipeline/camera_json.hpp"
#include "pipeline/files.hpp"

namespace seampath {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using portable::radians;

constexpr double kOwnShade = 1e-3;  // mm; the point itself must not shade itself

/// The laser and the camera at one place of the travel, scene frame.
struct StripeStation {
    Vector3d middle;    ///< what both look at
    Vector3d to_laser;  ///< unit
    Vector3d across;    ///< unit, in the laser's plane, to the right of the picture
    Isometry3d scene_from_camera;
};

StripeStation station_at(const StripeRig& rig, const Vector3d& middle) {
    const auto [st, ct] = portable::sincos(radians(rig.tilt_deg));
    const auto [sa, ca] = portable::sincos(radians(rig.triangulation_deg));
    StripeStation s;
    s.middle = middle;
    s.to_laser = Vector3d(0, st, ct);
    s.across = s.to_laser.cross(Vector3d::UnitX());
    const Vector3d to_camera = ca * s.to_laser - sa * Vector3d::UnitX();
    s.scene_from_camera = Isometry3d::Identity();
    s.scene_from_camera.linear() << s.across, (-to_camera).cross(s.across), -to_camera;
    s.scene_from_camera.translation() = middle + rig.distance_mm * to_camera;
    return s;
}

bool is_visible(const Scene& scene, const Vector3d& p, const Vector3d& eye) {
    const Vector3d ray = p - eye;
    const double distance = ray.norm();
    return !first_hit(scene.surfaces, {eye, ray / distance}, distance - kOwnShade);
}

/// The lit places that the camera sees, as polylines of pixels: broken where a place is hidden, or steps back.
std::vector<std::vector<Vector2d>> courses_at(const Scene& scene, const StripeRig& rig, const CameraModel& camera,
                                              const StripeStation& station) {
    constexpr double kRaysPerPixel = 3;
    constexpr double kBesidePicture = 1.2;  // times the picture's half width: nothing ends at its border
    const double step = rig.distance_mm / rig.focal_px / kRaysPerPixel;
    const int rays = static_cast<int>(kBesidePicture * kRaysPerPixel * rig.width);
    const Vector3d laser = station.middle + rig.distance_mm * station.to_laser;
    const Vector3d eye = station.scene_from_camera.translation();
    const Isometry3d camera_from_scene = station.scene_from_camera.inverse();
    std::vector<std::vector<Vector2d>> courses;
    Vector3d before = laser;  // the last lit place: at first none, so far away
    for (int i = -rays / 2; i <= rays / 2; ++i) {
        const Vector3d direction = (station.middle + i * step * station.across - laser).normalized();
        const auto hit = first_hit(scene.surfaces, {laser, direction});
        const Vector3d p = hit ? Vector3d(laser + hit->t * direction) : laser;
        if (!hit || !is_visible(scene, p, eye)) {
            before = laser;
            continue;
        }
        // Steep places spread the rays; a step is a jump along them.
        if ((p - before).norm() > 20 * step) {
            courses.emplace_back();
        }
        courses.back().push_back(pixel_of(camera, camera_from_scene * p));
        before = p;
    }
    return courses;
}

nlohmann::ordered_json capture_json(const StripeSequence& s) {
    nlohmann::ordered_json frames = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < s.images.size(); ++i) {
        frames.push_back({{"image", std::to_string(1000 + i).substr(1) + ".png"},
                          {"base_from_camera", pose_numbers(s.base_from_camera[i])}});
    }
    return {{"kind", "laser_stripe"},
            {"camera", camera_json(s.camera)},
            {"laser_plane", plane_json({s.plane_normal, s.plane_distance_mm})},
            {"frames", frames}};
}

}  // namespace

StripeSequence make_stripe_sequence(const SceneOptions& scene_options, const StripeRig& rig, const StripeNoise& noise,
                                    std::uint64_t seed, unsigned threads) {
    const Scene scene = make_scene(resolved(scene_options, seed));
    StripeSequence s;
    s.camera = {rig.width,
                rig.height,
                {rig.focal_px, rig.focal_px},
                {0.5 * (rig.width - 1), 0.5 * (rig.height - 1)},
                rig.distortion};
    s.truth = scene.truth;
    Vector3d middle(0, 0, 0);
    for (const TruthPoint& point : s.truth.seams.front().points) {
        middle += point.p / static_cast<double>(s.truth.seams.front().points.size());
    }
    s.images.resize(static_cast<std::size_t>(rig.images));
    s.base_from_camera.resize(s.images.size());
    for_rows(static_cast<std::uint32_t>(rig.images), threads, [&](std::uint32_t i) {
        const double x = middle.x() + rig.step_mm * (i - 0.5 * (rig.images - 1));
        const StripeStation station = station_at(rig, {x, middle.y(), middle.z()});
        StripePicture picture;
        picture.width = rig.width;
        picture.height = rig.height;
        picture.width_px = rig.stripe_width_px;
        picture.courses = courses_at(scene, rig, s.camera, station);
        s.images[i] = draw_stripes(picture, noise, seed * 65537 + i);
        s.base_from_camera[i] = station.scene_from_camera;
    });
    const Isometry3d& first = s.base_from_camera.front();
    s.plane_normal = first.linear().transpose() * Vector3d::UnitX();
    s.plane_distance_mm = rig.distance_mm * portable::sin(radians(rig.triangulation_deg));
    return s;
}

std::filesystem::path write_stripe_sequence(const StripeSequence& sequence, const std::filesystem::path& folder) {
    const RunFolder files(folder);
    for (std::size_t i = 0; i < sequence.images.size(); ++i) {
        files.write(std::to_string(1000 + i).substr(1) + ".png", png_bytes(sequence.images[i]));
    }
    files.write("capture.json", capture_json(sequence).dump(2) + "\n");
    return folder / "capture.json";
}

}  // namespace seampath
