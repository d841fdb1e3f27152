#include "stages/depth/depth.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "datasets/depth_picture.hpp"
#include "datasets/score.hpp"
#include "stages/extract/extract.hpp"
#include "stages/read/read.hpp"

namespace seampath {
namespace depth_test {

using Eigen::Vector3d;

const CameraModel kCamera{640, 480, {1500, 1500}, {319.5, 239.5}, {-0.1, 0.05, 0.0005, -0.0004, 0}};

struct DepthView {
    Scene scene;
    Eigen::Isometry3d scene_from_camera;
    GreyImage image;
};

DepthView view_of(SceneKind kind, const DepthNoise& noise, double elevation_deg = 40) {
    SceneOptions options;
    options.kind = kind;
    options.length_mm = 100;
    DepthView view{make_scene(resolved(options, 1)), {}, {}};
    view.scene_from_camera = front_view(view.scene, 500, elevation_deg);
    view.image = make_depth_picture(view.scene, kCamera, view.scene_from_camera, noise, 1, 2);
    return view;
}

double distance_from_surfaces(const Scene& scene, const Vector3d& p) {
    double nearest = 1e9;
    for (const Surface& surface : scene.surfaces) {
        nearest = std::min(nearest, std::abs(signed_value(surface.shape, p)));
    }
    return nearest;
}

TEST(Depth, PointsLieOnTheSurfacesAndKeepTheirPixels) {
    DepthNoise exact{0, 500, 0, 0, 0.01};
    const DepthView view = view_of(SceneKind::tee, exact);
    const DepthScan result = scan_of_depth(view.image, kCamera, 0.01, view.scene_from_camera);
    const Scan& scan = result.scan;
    ASSERT_EQ(scan.points.size() + result.without_depth + result.mixed, 640U * 480U);
    ASSERT_EQ(scan.points.size(), scan.pixel.size());
    EXPECT_GT(scan.points.size(), 50000U);
    EXPECT_EQ(result.mixed, 0U);
    for (std::size_t i = 0; i < scan.points.size(); i += 97) {
        EXPECT_LT(distance_from_surfaces(view.scene, scan.position(i)), 0.006) << i;
        const Vector3d p = view.scene_from_camera.inverse() * scan.position(i);
        const Eigen::Vector2d pixel(scan.pixel[i] % 640, scan.pixel[i] / 640);
        EXPECT_LT((pixel_of(kCamera, p) - pixel).norm(), 1e-3);
    }
}

// A box seen from above its front: beyond its top edge lies the plate, 50 mm deeper.
TEST(Depth, MixedPixelsAreLeftOut) {
    const DepthNoise noise;
    const DepthView view = view_of(SceneKind::box_on_plate, noise, 65);
    const DepthScan result = scan_of_depth(view.image, kCamera, noise.mm_per_unit, view.scene_from_camera);
    const auto is_off = [&](const Vector3d& p) { return distance_from_surfaces(view.scene, p) > 1; };
    double in_image = 0, in_scan = 0;
    for (int r = 0; r < kCamera.height; ++r) {
        for (int c = 0; c < kCamera.width; ++c) {
            const Vector3d p = noise.mm_per_unit * view.image.at(c, r) * *direction_of(kCamera, {c, r});
            in_image += view.image.at(c, r) > 0 && is_off(view.scene_from_camera * p);
        }
    }
    for (std::size_t i = 0; i < result.scan.points.size(); ++i) {
        in_scan += is_off(result.scan.position(i));
    }
    EXPECT_GT(in_image, 50);
    EXPECT_LT(in_scan, 0.1 * in_image);
    EXPECT_LT(static_cast<double>(result.mixed), 3 * in_image) << "and little else";
    EXPECT_NEAR(result.noise_per_mm2 * 500 * 500, noise.sigma_mm, 0.2 * noise.sigma_mm);
    RecordProperty("in_image", std::to_string(in_image));
    RecordProperty("in_scan", std::to_string(in_scan));
    RecordProperty("left_out", std::to_string(result.mixed));
}

TEST(Depth, SeamOfATeeIsFound) {
    const DepthNoise noise;
    const DepthView view = view_of(SceneKind::tee, noise);
    const DepthScan result = scan_of_depth(view.image, kCamera, noise.mm_per_unit, view.scene_from_camera);
    const Extraction extraction = extract(result.scan, {});
    ASSERT_EQ(extraction.seams.size(), 1U);
    EXPECT_EQ(extraction.seams[0].kind, JointKind::fillet);
    const Score found = score(extraction.seams, view.scene.truth);
    EXPECT_LT(found.rms_mm, 0.03);
    EXPECT_EQ(found.false_share, 0);
    RecordProperty("rms_mm", std::to_string(found.rms_mm));
}

// The depths of a real organised cloud of a sensor with 525 px of focal length, as an image of 0.1 mm a unit: the
// cloud's points come back, but for the few at the borders of things.
TEST(Depth, RealOrganisedCloudComesBack) {
    const auto file = std::filesystem::path(SEAMPATH_SOURCE_DIR) / ".." / "shared" / "scans" / "rgbd" / "learn17.pcd";
    if (!std::filesystem::exists(file)) {
        GTEST_SKIP() << "the real scans are not on this machine: " << file;
    }
    const Scan cloud = read(file, {});
    ASSERT_EQ(cloud.width, 640U);
    const CameraModel camera{640, 480, {525, 525}, {319.5, 239.5}, {}};
    GreyImage image{640, 480, 65535, std::vector<float>(640UL * 480, 0)};
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
        image.value[cloud.pixel[i]] = static_cast<float>(std::round(10 * cloud.position(i).z()));
    }
    const DepthScan result = scan_of_depth(image, camera, 0.1, Eigen::Isometry3d::Identity());
    EXPECT_LT(static_cast<double>(result.mixed), 0.02 * static_cast<double>(cloud.points.size()));
    std::size_t k = 0;
    double worst = 0;
    for (std::size_t i = 0; i < result.scan.points.size(); ++i) {
        while (cloud.pixel[k] < result.scan.pixel[i]) {
            ++k;
        }
        worst = std::max(worst, (result.scan.position(i) - cloud.position(k)).norm());
    }
    EXPECT_LT(worst, 1) << "of some thousand mm";
}

}  // namespace depth_test
}  // namespace seampath
