#include "stages/geometry/flank_surface.hpp"

#include <gtest/gtest.h>

#include "stages/error.hpp"
#include "tests/geometry/patches.hpp"

namespace seampath {
namespace flank_surface_test {

using Eigen::Vector3d;

const Vector3d kAxis = Vector3d(1, 2, 3).normalized();
const Patch kPatches[] = {{Plane{{1, 2, 3}, kAxis}, -20, 20, -20, 20},
                          {Cylinder{{1, 2, 3}, kAxis, 12}, 0, 4, -20, 20},
                          {Cone{{1, 2, 3}, kAxis, 0.4}, 0, 4, 20, 60},
                          {Sphere{{1, 2, 3}, 12}, 0, 4, -1, 1}};

TEST(FlankSurface, ComesBackAsTheSameFit) {
    const Vector3d origin(100, -200, 300);
    for (const Patch& patch : kPatches) {
        for (const bool bore : {false, true}) {
            PatchPoints made = points_of(patch, 800, {0.05, 0, 0}, 3);
            if (bore) {
                turn_inside_out(made);
            }
            const auto fit = fit_like(patch.shape, made);
            ASSERT_TRUE(fit);
            const FlankSurface plain = flank_surface(*fit, fit->covariance());
            EXPECT_EQ(static_cast<std::size_t>(plain.shape), patch.shape.index());
            const SurfaceFit same = surface_fit(plain, Vector3d::Zero()), moved = surface_fit(plain, origin);
            EXPECT_EQ(same.covariance(), fit->covariance());
            EXPECT_EQ(same.scale(), fit->scale());
            EXPECT_EQ(same.share_taken(), fit->share_taken());
            for (const Vector3d& p : made.points) {
                EXPECT_EQ(same.distance(p), fit->distance(p));
                EXPECT_EQ(same.sigma(p), fit->sigma(p));
                EXPECT_NEAR(moved.distance(p - origin), fit->distance(p), 1e-12);
                EXPECT_NEAR(moved.sigma(p - origin), fit->sigma(p), 1e-12);
            }
        }
    }
}

TEST(FlankSurface, RefusesACovarianceOfAnotherSize) {
    const auto fit = fit_like(kPatches[0].shape, points_of(kPatches[0], 200, {0.05, 0, 0}, 3));
    FlankSurface plain = flank_surface(*fit, fit->covariance());
    plain.shape = SurfaceShape::cylinder;
    EXPECT_THROW(surface_fit(plain, Vector3d::Zero()), InputError);
}

}  // namespace flank_surface_test
}  // namespace seampath
