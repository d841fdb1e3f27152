#include "datasets/depth_picture.hpp"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "datasets/picture_file.hpp"
#include "datasets/portable_math.hpp"
#include "datasets/rng.hpp"
#include "datasets/rows.hpp"
#include "pipeline/camera_json.hpp"
#include "pipeline/files.hpp"
#include "stages/error.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;

enum DepthStream : std::uint64_t { kDepthNoise = 60, kDepthDropout, kDepthMixed };

constexpr double kLeastStep = 0.5;  // mm of depth; smaller steps mix no pixels

/// True depths; 0 where the ray meets nothing.
std::vector<double> true_depths(const Scene& scene, const CameraModel& camera,
                                const Eigen::Isometry3d& scene_from_camera, unsigned threads) {
    const auto width = static_cast<std::uint32_t>(camera.width);
    std::vector<double> depths(std::size_t{width} * static_cast<std::size_t>(camera.height));
    for_rows(static_cast<std::uint32_t>(camera.height), threads, [&](std::uint32_t row) {
        for (std::uint32_t column = 0; column < width; ++column) {
            const auto direction = direction_of(camera, Eigen::Vector2d(column, row));
            if (!direction) {
                continue;
            }
            const Vector3d sight = scene_from_camera.linear() * *direction;
            const auto hit = first_hit(scene.surfaces, {scene_from_camera.translation(), sight.normalized()});
            depths[std::size_t{row} * width + column] = hit ? hit->t / sight.norm() : 0;
        }
    });
    return depths;
}

/// The neighbour's depth that differs most, where it differs by a step; else the pixel's own.
double across_step(const std::vector<double>& depths, const CameraModel& camera, int column, int row) {
    const auto at = [&](int c, int r) {
        return depths[static_cast<std::size_t>(r) * static_cast<std::size_t>(camera.width) +
                      static_cast<std::size_t>(c)];
    };
    const double here = at(column, row);
    // What a surface seen at 80 degrees changes from pixel to pixel is no step.
    const double least = std::max(kLeastStep, 5.67 * here / camera.focal_px.x());
    double other = here;
    for (const auto& [dc, dr] : {std::pair(-1, 0), std::pair(1, 0), std::pair(0, -1), std::pair(0, 1)}) {
        const int c = column + dc, r = row + dr;
        const bool inside = c >= 0 && r >= 0 && c < camera.width && r < camera.height;
        if (inside && at(c, r) > 0 && std::abs(at(c, r) - here) > std::max(least, std::abs(other - here))) {
            other = at(c, r);
        }
    }
    return other;
}

}  // namespace

GreyImage make_depth_picture(const Scene& scene, const CameraModel& camera, const Eigen::Isometry3d& scene_from_camera,
                             const DepthNoise& noise, std::uint64_t seed, unsigned threads) {
    const std::vector<double> depths = true_depths(scene, camera, scene_from_camera, threads);
    const Random errors(seed, kDepthNoise), lost(seed, kDepthDropout), mixed(seed, kDepthMixed);
    GreyImage image{camera.width, camera.height, 65535, {}};
    for (int row = 0; row < camera.height; ++row) {
        for (int column = 0; column < camera.width; ++column) {
            const std::uint64_t i = image.value.size();
            const double z = depths[i];
            if (z <= 0 || lost.uniform(i) < noise.dropout) {
                image.value.push_back(0);
                continue;
            }
            double seen = z;
            if (mixed.uniform(2 * i) < noise.mixed_pixels) {
                seen += mixed.uniform(2 * i + 1) * (across_step(depths, camera, column, row) - z);
            }
            const double far = z / noise.working_distance_mm;
            const double units = (seen + noise.sigma_mm * far * far * errors.normal(i)) / noise.mm_per_unit;
            ensure(units < 65535, "the depths fit the image");
            image.value.push_back(static_cast<float>(std::floor(units + 0.5)));
        }
    }
    return image;
}

std::filesystem::path write_depth_capture(const GreyImage& image, const CameraModel& camera,
                                          const Eigen::Isometry3d& scene_from_camera, const DepthNoise& noise,
                                          const std::filesystem::path& folder) {
    const nlohmann::ordered_json capture{{"kind", "depth"},
                                         {"camera", camera_json(camera)},
                                         {"image", "depth.png"},
                                         {"mm_per_unit", noise.mm_per_unit},
                                         {"base_from_camera", pose_numbers(scene_from_camera)}};
    const RunFolder files(folder);
    files.write("depth.png", png_bytes(image));
    files.write("capture.json", capture.dump(2) + "\n");
    return folder / "capture.json";
}

Eigen::Isometry3d front_view(const Scene& scene, double distance_mm, double elevation_deg) {
    const auto [s, c] = portable::sincos(portable::radians(elevation_deg));
    const Vector3d to_camera = c * scene.front + s * Vector3d::UnitZ();
    const Vector3d right = Vector3d::UnitZ().cross(scene.front).normalized();
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() << right, (-to_camera).cross(right), -to_camera;
    pose.translation() = scene.box.center() + distance_mm * to_camera;
    return pose;
}

}  // namespace seampath
