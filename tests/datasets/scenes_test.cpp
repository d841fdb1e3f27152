#include "datasets/scenes.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "datasets/portable_math.hpp"
#include "datasets/rng.hpp"
#include "stages/error.hpp"
#include "tests/datasets/scene_laws.hpp"

namespace seampath {
namespace scenes_test {

using Eigen::Vector3d;
using testing::HasSubstr;
using testing::ThrowsMessage;

class EveryScene : public testing::TestWithParam<SceneOptions> {};
INSTANTIATE_TEST_SUITE_P(Scenes, EveryScene, all_scenes(), scene_test_name);

/// A surface through p with this normal, within its edges.
bool lies_on_surface(const Scene& scene, const Vector3d& p, const Vector3d& n) {
    for (const Surface& surface : scene.surfaces) {
        bool inside = true;
        for (const SceneShape& other : surface.inside_of) {
            inside = inside && signed_value(other, p) < 1e-9;
        }
        if (inside && std::abs(signed_value(surface.shape, p)) < 1e-9 && (normal(surface.shape, p) - n).norm() < 1e-9) {
            return true;
        }
    }
    return false;
}

/// The part without what only lies on it.
Scene bare_scene(SceneOptions o, std::uint64_t seed = 1) {
    o.spatter_per_100mm = 0;
    o.tack_spacing_mm = 1e9;
    return make_scene(resolved(o, seed));
}

TEST_P(EveryScene, TruthLiesOnBothSurfaces) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const Scene scene = make_scene(resolved(GetParam(), seed));
        EXPECT_EQ(scene.truth.seams.empty(), GetParam().kind == SceneKind::plain);
        for (const TruthSeam& seam : scene.truth.seams) {
            // The edges beside the ends of a groove's middle may lie just beyond the plates' ends.
            const std::size_t margin = seam.groove ? 50 : 0;
            for (std::size_t i = margin; i + margin < seam.points.size(); ++i) {
                const TruthPoint& point = seam.points[i];
                const Feet f = feet(seam, point);
                ASSERT_TRUE(lies_on_surface(scene, f.p1, point.n1)) << point.p.transpose();
                ASSERT_TRUE(lies_on_surface(scene, f.p2, point.n2)) << point.p.transpose();
            }
        }
    }
}

TEST_P(EveryScene, NormalsAndTangentAreUnitAndRightHanded) {
    for (const TruthSeam& seam : make_scene(resolved(GetParam(), 1)).truth.seams) {
        for (const TruthPoint& point : seam.points) {
            ASSERT_NEAR(point.n1.norm(), 1, 1e-12);
            ASSERT_NEAR(point.n2.norm(), 1, 1e-12);
            ASSERT_NEAR(point.tangent.norm(), 1, 1e-12);
            if (seam.kind == JointKind::butt) {
                ASSERT_EQ((point.n1 - point.n2).norm(), 0);
                ASSERT_NEAR(point.tangent.dot(point.n1), 0, 1e-12);
            } else {
                ASSERT_NEAR((point.tangent - point.n1.cross(point.n2).normalized()).norm(), 0, 1e-12);
            }
        }
    }
}

TEST_P(EveryScene, TruthIsDenseAndInTheDirectionOfTravel) {
    const Scene scene = make_scene(resolved(GetParam(), 1));
    for (const TruthSeam& seam : scene.truth.seams) {
        const std::size_t n = seam.points.size();
        for (std::size_t i = 0; i < (seam.closed ? n : n - 1); ++i) {
            const TruthPoint& a = seam.points[i];
            const TruthPoint& b = seam.points[(i + 1) % n];
            ASSERT_LE((b.p - a.p).norm(), 0.1);
            ASSERT_GT((b.p - a.p).norm(), 0.01);
            // A chord deviates from the mean tangent by the third order only.
            ASSERT_GT((b.p - a.p).normalized().dot((a.tangent + b.tangent).normalized()), 1 - 1e-6);
        }
    }
}

TEST_P(EveryScene, FlanksBoundTheMaterialAsTheJointKindSays) {
    const Scene scene = bare_scene(GetParam());
    for (const TruthSeam& seam : scene.truth.seams) {
        for (std::size_t i = 50; i + 50 < seam.points.size(); i += 50) {
            const TruthPoint& point = seam.points[i];
            const Feet f = feet(seam, point);
            for (const auto& [p, along, n] : {std::tuple(f.p1, f.along1, point.n1), {f.p2, f.along2, point.n2}}) {
                // Along either flank: surface with air above. On past the seam: inside the material where the flanks
                // face each other, air at an outer corner.
                ASSERT_GT(part_value(scene, p + along + 0.1 * n), 0) << i;
                ASSERT_LT(part_value(scene, p + along - 0.1 * n), 0) << i;
                if (seam.kind == JointKind::corner) {
                    ASSERT_GT(part_value(scene, p - along - 0.1 * n), 0) << i;
                } else if (!seam.groove) {
                    ASSERT_LT(part_value(scene, p - along + 0.1 * n), 0) << i;
                }
            }
            ASSERT_TRUE(!seam.groove || part_value(scene, point.p) > 0) << i;
        }
    }
}

/// The ray leaves the material again before it has gone that far in it: marching may step over the place.
bool grazes(const Scene& scene, const Ray& ray, double t, double far) {
    const auto value = [&](double further) { return part_value(scene, ray.origin + (t + further) * ray.direction); };
    return value(1e-6) < 0 && value(far) > 0;
}

TEST_P(EveryScene, RaysHitWhatMarchingThroughTheSolidHits) {
    const Scene scene = make_scene(resolved(GetParam(), 1));
    const Random random(5, 0);
    const double reach = scene.box.diagonal().norm();
    const double kStep = 0.1;
    int hits = 0;
    for (std::uint64_t i = 0; i < 150; ++i) {
        Vector3d target;
        Vector3d from;
        for (int axis = 0; axis < 3; ++axis) {
            const auto draw = 10 * i + static_cast<std::uint64_t>(axis);
            target[axis] = random.uniform(draw, scene.box.min()[axis], scene.box.max()[axis]);
            from[axis] = random.normal(draw + 3);
        }
        from.z() = std::abs(from.z());
        const Ray ray{target + reach * from.normalized(), -from.normalized()};
        double marched = 0;
        while (marched < 2 * reach && part_value(scene, ray.origin + marched * ray.direction) > 0) {
            marched += kStep;
        }
        const auto hit = first_hit(scene.surfaces, ray);
        if (hit && grazes(scene, ray, hit->t, kStep)) {
            continue;
        }
        ASSERT_EQ(hit.has_value(), marched < 2 * reach) << i;
        if (hit) {
            ++hits;
            ASSERT_NEAR(part_value(scene, ray.origin + hit->t * ray.direction), 0, 1e-9) << i;
            ASSERT_NEAR(hit->t, marched, kStep + 1e-9) << i;
        }
    }
    EXPECT_GT(hits, 100);
}

TEST_P(EveryScene, SeedVariesTheSizeByAFifth) {
    SceneOptions options = GetParam();
    options.vary = false;
    const SceneOptions usual = resolved(options, 1);
    const auto size = usual.height_mm ? &SceneOptions::height_mm : &SceneOptions::length_mm;
    EXPECT_EQ(usual.*size, resolved(options, 2).*size);
    options.vary = true;
    EXPECT_NE(resolved(options, 1).*size, resolved(options, 2).*size);
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
        EXPECT_NEAR(*(resolved(options, seed).*size) / *(usual.*size), 1, 0.2);
        EXPECT_NO_THROW(make_scene(resolved(options, seed)));
    }
}

double length(const TruthSeam& seam) {
    double sum = 0;
    for (std::size_t i = 0; i + (seam.closed ? 0 : 1) < seam.points.size(); ++i) {
        sum += (seam.points[(i + 1) % seam.points.size()].p - seam.points[i].p).norm();
    }
    return sum;
}

TEST(Scenes, SeamsHaveTheLengthThatGeometryGives) {
    SceneOptions tee;
    tee.length_mm = 150;
    const Scene web = make_scene(resolved(tee, 3));
    ASSERT_EQ(web.truth.seams.size(), 2U);
    EXPECT_NEAR(length(web.truth.seams[0]), 150, 1e-9);
    EXPECT_NEAR(length(web.truth.seams[1]), 150, 1e-9);

    SceneOptions box;
    box.kind = SceneKind::box_on_plate;
    box.length_mm = 100;
    box.width_mm = 70;
    box.corner_radius_mm = 12;
    EXPECT_NEAR(length(make_scene(resolved(box, 3)).truth.seams.at(0)), 2 * (76 + 46) + 24 * portable::kPi, 1e-3);

    SceneOptions pipe;
    pipe.kind = SceneKind::pipe_on_plate;
    pipe.radius_mm = 30;
    pipe.lean_deg = 0;
    EXPECT_NEAR(length(make_scene(resolved(pipe, 3)).truth.seams.at(0)), 60 * portable::kPi, 1e-3);
}

TEST(Scenes, SaddleGoesThroughTheFourPointsThatPythagorasGives) {
    SceneOptions options;
    options.kind = SceneKind::pipe_on_pipe;
    options.header_radius_mm = 50;
    options.radius_mm = 30;
    const Scene scene = make_scene(resolved(options, 1));
    for (const Vector3d& expected :
         {Vector3d(30, 0, 50), Vector3d(-30, 0, 50), Vector3d(0, 30, 40), Vector3d(0, -30, 40)}) {
        double nearest = 1e9;
        for (const TruthPoint& point : scene.truth.seams.at(0).points) {
            nearest = std::min(nearest, (point.p - expected).norm());
        }
        EXPECT_LT(nearest, 0.05);
    }
}

TEST(Scenes, WebEndsFlushWithThePlate) {
    for (const SceneKind kind : {SceneKind::tee, SceneKind::s_curve}) {
        const Scene scene = make_scene(scene_options(static_cast<int>(kind)));
        for (const TruthSeam& seam : scene.truth.seams) {
            EXPECT_FALSE(seam.closed);
            EXPECT_NEAR(std::abs(seam.points.front().p.x()), scene.box.max().x(), 1e-9);
            EXPECT_NEAR(std::abs(seam.points.back().p.x()), scene.box.max().x(), 1e-9);
        }
    }
}

TEST(Scenes, ImpossiblePartsAreRefused) {
    SceneOptions box;
    box.kind = SceneKind::box_on_plate;
    box.corner_radius_mm = 90;
    EXPECT_THAT([&] { make_scene(resolved(box, 1)); }, ThrowsMessage<InputError>(HasSubstr("corner radius 90 mm")));
    SceneOptions pipes;
    pipes.kind = SceneKind::pipe_on_pipe;
    pipes.header_radius_mm = 40;
    pipes.radius_mm = 35;
    pipes.offset_mm = 6;
    EXPECT_THAT([&] { make_scene(resolved(pipes, 1)); },
                ThrowsMessage<InputError>(HasSubstr("beyond the header's radius 40 mm")));
    pipes.offset_mm = 0;
    pipes.header_length_mm = 60;
    EXPECT_THAT([&] { make_scene(resolved(pipes, 1)); }, ThrowsMessage<InputError>(HasSubstr("header length 60 mm")));
}

}  // namespace scenes_test
}  // namespace seampath
