#include <cmath>

#include <gtest/gtest.h>

#include "tests/datasets/scene_laws.hpp"

namespace seampath {
namespace spatter_test {

using Eigen::Vector3d;

SceneOptions spattered(Spattered joint, Course course = Course::straight) {
    SceneOptions o;
    o.kind = SceneKind::spatter;
    o.spattered = joint;
    o.course = course;
    return o;
}

Scene clean(SceneOptions o) {
    o.kind = o.spattered == Spattered::tee ? SceneKind::tee : SceneKind::lap;
    return make_scene(o);
}

std::vector<SphereShape> spheres(const Scene& scene) {
    std::vector<SphereShape> found;
    for (const Surface& surface : scene.surfaces) {
        if (const auto* sphere = std::get_if<SphereShape>(&surface.shape)) {
            found.push_back(*sphere);
        }
    }
    return found;
}

TEST(Spatter, TruthIsTheCleanSeam) {
    for (const SceneOptions& asked : {spattered(Spattered::tee), spattered(Spattered::lap, Course::arc)}) {
        const SceneOptions o = resolved(asked, 3);
        const Truth bare = clean(o).truth;
        const Truth truth = make_scene(o).truth;
        ASSERT_EQ(truth.seams.size(), bare.seams.size());
        for (std::size_t s = 0; s < bare.seams.size(); ++s) {
            EXPECT_EQ(truth.seams[s].kind, bare.seams[s].kind);
            ASSERT_EQ(truth.seams[s].points.size(), bare.seams[s].points.size());
            for (std::size_t i = 0; i < bare.seams[s].points.size(); ++i) {
                ASSERT_EQ(truth.seams[s].points[i].p, bare.seams[s].points[i].p);
            }
        }
    }
}

TEST(Spatter, BallsAreAsManyAsAskedAndLieOnThePart) {
    for (const double per_100mm : {0.0, 2.0, 10.0}) {
        SceneOptions o = spattered(Spattered::tee);
        o.length_mm = 200;
        o.spatter_per_100mm = per_100mm;
        o.tack_spacing_mm = 1e6;
        o = resolved(o, 5);
        const Scene bare = clean(o);
        const std::vector<SphereShape> balls = spheres(make_scene(o));
        EXPECT_EQ(static_cast<double>(balls.size()), 4 * per_100mm);  // two seams of 200 mm
        for (const SphereShape& ball : balls) {
            EXPECT_GE(2 * ball.radius, 0.3);
            EXPECT_LE(2 * ball.radius, 3);
            const double height = part_value(bare, ball.p);
            EXPECT_GE(height, -1e-9);
            EXPECT_LE(height, ball.radius + 1e-9);
        }
    }
}

TEST(Spatter, TacksSitOnTheSeamAndReachTheirLeg) {
    for (const SceneOptions& asked : {spattered(Spattered::tee), spattered(Spattered::lap, Course::s_curve)}) {
        SceneOptions o = asked;
        o.length_mm = 180;
        o.spatter_per_100mm = 0;
        o.tack_spacing_mm = 45;
        o.tack_length_mm = 8;
        o.tack_leg_mm = 2.5;
        o = resolved(o, 1);
        const Scene scene = make_scene(o);
        std::size_t bars = 0;
        for (const Surface& surface : scene.surfaces) {
            const auto* bar = std::get_if<CylinderShape>(&surface.shape);
            if (!bar) {
                continue;
            }
            ++bars;
            EXPECT_EQ(bar->radius, 2.5);
            double nearest = 1e9;
            for (const TruthSeam& seam : scene.truth.seams) {
                for (const TruthPoint& point : seam.points) {
                    nearest = std::min(nearest, (point.p - bar->p - 4 * bar->axis).norm());
                }
            }
            EXPECT_LT(nearest, 0.1);
        }
        EXPECT_EQ(bars, 4 * scene.truth.seams.size());
        EXPECT_EQ(spheres(scene).size(), 2 * bars);
    }
}

TEST(Spatter, ComesFromTheSeedAndIsRemadeFromTheOptions) {
    const SceneOptions one = resolved(spattered(Spattered::tee), 1);
    const SceneOptions other = resolved(spattered(Spattered::tee), 2);
    EXPECT_GT(one.spatter_seed, 0);
    EXPECT_NE(one.spatter_seed, other.spatter_seed);
    EXPECT_EQ(one.spatter_seed, resolved(one, 2).spatter_seed);
    SceneOptions moved = one;
    moved.spatter_seed = other.spatter_seed;
    const auto first = spheres(make_scene(one));
    const auto second = spheres(make_scene(moved));
    ASSERT_FALSE(first.empty());
    ASSERT_FALSE(second.empty());
    EXPECT_NE(first[0].p, second[0].p);
    EXPECT_EQ(first[0].p, spheres(make_scene(one))[0].p);
    EXPECT_EQ(resolved(SceneOptions{}, 1).spatter_seed, 0);
}

}  // namespace spatter_test
}  // namespace seampath
