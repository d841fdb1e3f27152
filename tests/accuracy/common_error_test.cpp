#include "tests/accuracy/common_error.hpp"

#include <functional>

#include <gtest/gtest.h>

namespace seampath {
namespace common_error_test {

using Eigen::Vector3d;

Dataset coarse_tee() {
    SceneOptions scene;
    scene.random_pose = false;
    scene.vary = false;
    scene.lean_deg = 0;
    ScannerOptions scanner;
    scanner.pitch_x_mm = scanner.pitch_y_mm = 1;
    scanner.views = 6;
    return make_dataset(scene, scanner, 3);
}

Dataset with_errors(Dataset dataset, const std::function<Vector3d(std::size_t)>& shift) {
    for (std::size_t v = 0; v < dataset.views.size(); ++v) {
        dataset.views[v].error = Eigen::Affine3d(Eigen::Translation3d(shift(v)));
    }
    return dataset;
}

TEST(CommonError, IsTheShiftThatAllViewsShareAcrossTheSeam) {
    const Dataset tee = coarse_tee();
    const Vector3d shift(0.4, -0.03, 0.04);  // the seams run along x
    const Truth moved = moved_with_views(with_errors(tee, [&](std::size_t) -> const Vector3d& { return shift; }));
    EXPECT_NEAR(common_error(tee.truth, moved), 0.05, 1e-6);
    for (std::size_t s = 0; s < moved.seams.size(); ++s) {
        const Vector3d by = moved.seams[s].points[7].p - tee.truth.seams[s].points[7].p;
        EXPECT_LT((by - Vector3d(0, -0.03, 0.04)).norm(), 1e-6);
    }
}

TEST(CommonError, IsNothingWhereTheViewsErrorsCancel) {
    const Dataset tee = coarse_tee();
    const Truth moved =
        moved_with_views(with_errors(tee, [](std::size_t v) { return Vector3d(0, 0, v % 2 == 0 ? 0.02 : -0.02); }));
    EXPECT_LT(common_error(tee.truth, moved), 1e-6) << "all six see the plate";
}

TEST(CommonError, CountsOnlyTheViewsThatSeeTheFlank) {
    // Views stand round the part; those behind the web do not see its front. Each tells the side it stands on by where
    // its points of the web lie.
    const Dataset tee = coarse_tee();
    std::vector<double> side(tee.views.size(), 0);
    for (std::size_t v = 0; v < tee.views.size(); ++v) {
        const std::size_t end = v + 1 < tee.views.size() ? tee.views[v + 1].first_point : tee.points.size();
        for (std::size_t i = tee.views[v].first_point; i < end; ++i) {
            side[v] += tee.points[i].z() > 5 && std::abs(tee.points[i].z()) < 40 ? tee.points[i].y() : 0;
        }
    }
    const Truth moved =
        moved_with_views(with_errors(tee, [&](std::size_t v) { return Vector3d(0, side[v] > 0 ? 0.02 : -0.01, 0); }));
    for (std::size_t s = 0; s < moved.seams.size(); ++s) {
        const TruthPoint &before = tee.truth.seams[s].points[50], &after = moved.seams[s].points[50];
        EXPECT_NEAR(after.p.y() - before.p.y(), before.p.y() > 0 ? 0.02 : -0.01, 1e-4);
    }
}

}  // namespace common_error_test
}  // namespace seampath
