#include <cmath>

#include <gtest/gtest.h>

#include "datasets/score.hpp"
#include "datasets/stripe_sequence.hpp"
#include "stages/extract/extract.hpp"
#include "stages/geometry/parallel.hpp"
#include "stages/stripe/stripe.hpp"

namespace seampath {
namespace sequence_test {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kSeamRms = 0.03;  // mm

StripeRig half_of_the_way() {
    StripeRig rig;
    rig.images = 100;
    return rig;
}

// A laser line carried along a made part, measured.
struct Sequence {
    StripeSequence made;
    LaserPlane plane;
    std::vector<Profile> profiles;

    Sequence(const SceneOptions& scene, const StripeRig& rig) {
        StripeNoise noise;
        noise.sigma = 4;
        noise.speckle = 0.1;
        made = make_stripe_sequence(scene, rig, noise, 1, 2);
        plane = {made.plane_normal, made.plane_distance_mm};
        profiles.resize(made.images.size());
        parallel_for(profiles.size(), 1, [&](std::size_t i) {
            for (const Stripe& stripe : find_stripes(made.images[i], 1)) {
                profiles[i] = triangulate(stripe, made.camera, plane);
            }
        });
    }
};

// Distance across the true seam that is nearest.
double distance_across(const Truth& truth, const Vector3d& p) {
    double nearest = 1e9, across = 0;
    for (const TruthSeam& seam : truth.seams) {
        for (const TruthPoint& point : seam.points) {
            const Vector3d d = p - point.p;
            if (d.norm() < nearest) {
                nearest = d.norm();
                across = (d - d.dot(point.tangent) * point.tangent).norm();
            }
        }
    }
    return across;
}

void expect_seam_profile_by_profile(const Sequence& s, JointKind kind) {
    double squares = 0;
    int found = 0;
    for (std::size_t i = 0; i < s.profiles.size(); ++i) {
        if (const auto point = find_seam_point(s.profiles[i], s.plane, kind)) {
            const double off = distance_across(s.made.truth, s.made.base_from_camera[i] * point->p);
            squares += off * off;
            ++found;
            EXPECT_LT(off, 6 * point->sigma_mm) << "profile " << i;
        }
    }
    EXPECT_GE(found, 0.95 * static_cast<double>(s.profiles.size()));
    EXPECT_LE(std::sqrt(squares / found), kSeamRms);
    ::testing::Test::RecordProperty("profiles_rms_mm", std::to_string(std::sqrt(squares / found)));
}

void expect_seam_of_cloud(const Sequence& s, JointKind kind) {
    const StripeScan cloud = scan_of_profiles(s.profiles, s.made.base_from_camera, s.made.camera.width);
    ASSERT_EQ(cloud.sigma_mm.size(), cloud.scan.points.size());
    const Extraction extraction = extract(cloud.scan, {});
    ASSERT_EQ(extraction.seams.size(), 1U);
    EXPECT_EQ(extraction.seams[0].kind, kind);
    const Score result = score(extraction.seams, s.made.truth);
    EXPECT_LE(result.rms_mm, kSeamRms);
    EXPECT_EQ(result.false_share, 0);
    // What the sensor passed, less what the ends of the scan leave in doubt.
    const double passed = 0.4 * static_cast<double>(s.profiles.size() - 1);
    double length = 0;
    for (std::size_t i = 1; i < extraction.seams[0].points.size(); ++i) {
        length += (extraction.seams[0].points[i].p - extraction.seams[0].points[i - 1].p).norm();
    }
    EXPECT_GT(length, 0.95 * passed);
    ::testing::Test::RecordProperty("cloud_rms_mm", std::to_string(result.rms_mm));
}

TEST(StripeSequence, Tee) {
    SceneOptions scene;
    const Sequence s(scene, half_of_the_way());
    expect_seam_profile_by_profile(s, JointKind::fillet);
    expect_seam_of_cloud(s, JointKind::fillet);
}

TEST(StripeSequence, SCurve) {
    SceneOptions scene;
    scene.kind = SceneKind::s_curve;
    const Sequence s(scene, {});
    expect_seam_profile_by_profile(s, JointKind::fillet);
    expect_seam_of_cloud(s, JointKind::fillet);
}

TEST(StripeSequence, Lap) {
    SceneOptions scene;
    scene.kind = SceneKind::lap;
    StripeRig rig = half_of_the_way();
    rig.tilt_deg = 20;
    const Sequence s(scene, rig);
    expect_seam_profile_by_profile(s, JointKind::lap);
    expect_seam_of_cloud(s, JointKind::lap);
}

// Of a groove without a gap at its root: narrower than the stripe, a gap can't be told from the bevels' meeting.
TEST(StripeSequence, VGroove) {
    SceneOptions scene;
    scene.kind = SceneKind::v_groove;
    scene.gap_mm = 0;
    scene.mismatch_mm = 0;
    StripeRig rig = half_of_the_way();
    rig.tilt_deg = 0;
    expect_seam_profile_by_profile(Sequence(scene, rig), JointKind::v_groove);
}

TEST(StripeSequence, Butt) {
    SceneOptions scene;
    scene.kind = SceneKind::butt;
    scene.gap_mm = 2;
    StripeRig rig = half_of_the_way();
    rig.tilt_deg = 0;
    expect_seam_profile_by_profile(Sequence(scene, rig), JointKind::butt);
}

// Every point of the scan is as far from the true surfaces as its sigma says.
TEST(StripeSequence, SigmaOfEachPointIsItsError) {
    SceneOptions scene;
    StripeRig rig;
    rig.images = 5;
    const Sequence s(scene, rig);
    const StripeScan cloud = scan_of_profiles(s.profiles, s.made.base_from_camera, s.made.camera.width);
    double squares = 0, count = 0;
    for (std::size_t i = 0; i < cloud.scan.points.size(); ++i) {
        const Vector3d p = cloud.scan.position(i);
        if (std::abs(p.z()) < 0.5 && p.y() > 8 && p.y() < 35) {  // on the plate's top, clear of the web
            // The laser comes at 45 degrees: what lies off across the stripe is half of it off the plate.
            const double off = p.z() * std::sqrt(2.0);
            squares += off * off / (cloud.sigma_mm[i] * cloud.sigma_mm[i]);
            ++count;
        }
    }
    EXPECT_GT(count, 500);
    EXPECT_GT(std::sqrt(squares / count), 0.6);
    EXPECT_LT(std::sqrt(squares / count), 1.5);
}

// By hand: r^2 = 0.05, 1 + k1 r^2 + k2 r^4 + k3 r^6 = 0.9877525.
TEST(Camera, PixelsAreThoseOfBrownsModel) {
    const CameraModel camera{640, 480, {1000, 1000}, {0, 0}, {-0.25, 0.1, 0.001, -0.002, 0.02}};
    const Vector2d pixel = pixel_of(camera, {0.1, 0.2, 1});
    EXPECT_NEAR(pixel.x(), 98.67525, 1e-9);
    EXPECT_NEAR(pixel.y(), 197.6005, 1e-9);
}

TEST(Camera, DirectionsUndoTheLens) {
    const CameraModel camera{640, 480, {800, 810}, {322, 236}, {-0.25, 0.1, 0.001, -0.002, 0.02}};
    for (const Vector2d& pixel : {Vector2d(0, 0), Vector2d(639, 479), Vector2d(322, 236), Vector2d(100, 400)}) {
        const auto direction = direction_of(camera, pixel);
        ASSERT_TRUE(direction);
        EXPECT_LT((pixel_of(camera, 250 * *direction) - pixel).norm(), 1e-8);
    }
    CameraModel wild = camera;
    wild.distortion[0] = -5;
    EXPECT_FALSE(direction_of(wild, {0, 0}));
}

}  // namespace sequence_test
}  // namespace seampath
