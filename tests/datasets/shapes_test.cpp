#include "datasets/shapes.hpp"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "datasets/rng.hpp"

namespace seampath {
namespace shapes_test {

using Eigen::Vector3d;

/// Where the ray meets the shape, or -1.
double first(const SceneShape& shape, const Vector3d& from, const Vector3d& direction) {
    const auto hit = first_hit({{shape, {}}}, {from, direction.normalized()});
    return hit ? hit->t : -1;
}

/// Apex at the origin, opening upwards by this half-angle.
ConeShape upright(double angle, double side = 1) {
    return {Vector3d::Zero(), Vector3d::UnitZ(), std::sin(angle), std::cos(angle), side};
}

TEST(Shapes, ConeIsHitWhereElementaryGeometrySays) {
    const ConeShape cone = upright(M_PI / 4);
    EXPECT_NEAR(first(cone, {10, 0, 2}, {-1, 0, 0}), 8, 1e-12);                  // outside
    EXPECT_NEAR(first(cone, {0, 0, 2}, {-1, 0, 0}), 2, 1e-12);                   // from within
    EXPECT_NEAR(first(cone, {3, 0, 10}, {0, 0, -1}), 7, 1e-12);                  // down on its side
    EXPECT_NEAR(first(cone, {0, 1, 0}, {0, 0, 1}), 1, 1e-12);                    // up from before the apex
    EXPECT_NEAR(first(cone, {-4, 0, 0}, {1, 0, 1}), 2 * std::sqrt(2.0), 1e-12);  // along a line of the other side
    EXPECT_EQ(first(cone, {10, 0, -2}, {-1, 0, 0}), -1);                         // the other nappe is none of it
    EXPECT_EQ(first(cone, {4, 0, 2}, {1, 0, 1}), -1);                            // along its own line, beside it
    EXPECT_EQ(first(cone, {10, 5, 2}, {-1, 0, 0}), -1);                          // past it
}

TEST(Shapes, ValueIsTheDistanceAndNormalItsGradient) {
    const Random random(3, 1);
    const Vector3d axis = Vector3d(1, 2, 3).normalized();
    for (const double side : {1.0, -1.0}) {
        for (const SceneShape& shape :
             {SceneShape(ConeShape{{5, -3, 2}, axis, std::sin(0.6), std::cos(0.6), side}),
              SceneShape(CylinderShape{{5, -3, 2}, axis, 7, side}), SceneShape(SphereShape{{5, -3, 2}, 7})}) {
            for (std::uint64_t i = 0; i < 50; ++i) {
                // Beside the axis and beyond a cone's apex.
                const Vector3d beside = axis.unitOrthogonal();
                const Vector3d around = Eigen::AngleAxisd(random.uniform(3 * i, 0, 6.3), axis) * beside;
                const Vector3d p = Vector3d(5, -3, 2) + random.uniform(3 * i + 1, 5, 15) * axis +
                                   random.uniform(3 * i + 2, 4, 15) * around;
                const double value = signed_value(shape, p);
                const Vector3d on = p - value * normal(shape, p);
                EXPECT_NEAR(signed_value(shape, on), 0, 1e-12);
                EXPECT_NEAR((normal(shape, on) - normal(shape, p)).norm(), 0, 1e-12);
                for (int k = 0; k < 3; ++k) {
                    const Vector3d h = 1e-5 * Vector3d::Unit(k);
                    const double slope = (signed_value(shape, p + h) - signed_value(shape, p - h)) / 2e-5;
                    EXPECT_NEAR(slope, normal(shape, p)[k], 1e-8);
                }
            }
        }
    }
}

TEST(Shapes, FarRaysHitExactly) {
    const Random random(4, 1);
    int hits = 0;
    for (const SceneShape& shape :
         {SceneShape(upright(0.6)), SceneShape(upright(0.6, -1)), SceneShape(SphereShape{{1, 2, 10}, 8}),
          SceneShape(CylinderShape{{1, 2, 10}, Vector3d::UnitX(), 8, -1})}) {
        for (std::uint64_t i = 0; i < 200; ++i) {
            const Vector3d target(random.uniform(6 * i, -8, 8), random.uniform(6 * i + 1, -8, 8),
                                  random.uniform(6 * i + 2, 1, 19));
            const Vector3d away(random.normal(6 * i + 3), random.normal(6 * i + 4), random.normal(6 * i + 5));
            const Ray ray{target + 1000 * away.normalized(), -away.normalized()};
            if (const auto hit = first_hit({{shape, {}}}, ray)) {
                ++hits;
                EXPECT_NEAR(signed_value(shape, ray.origin + hit->t * ray.direction), 0, 1e-10);
                // Nothing before it: the value keeps its sign.
                for (double t = 900; t < hit->t - 0.01; t += 0.25) {
                    EXPECT_GT(signed_value(shape, ray.origin + t * ray.direction) *
                                  signed_value(shape, ray.origin + 900 * ray.direction),
                              0);
                }
            }
        }
    }
    EXPECT_GT(hits, 500);
}

}  // namespace shapes_test
}  // namespace seampath
