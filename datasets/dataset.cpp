#include "datasets/dataset.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <thread>

#include "datasets/portable_math.hpp"
#include "datasets/rng.hpp"
#include "stages/error.hpp"
#include "stages/geometry/parallel.hpp"

namespace seampath {
namespace {

constexpr std::uint64_t kPoseStream = 2;

/// Uniform over all rotations (a normalised four-dimensional Gaussian), uniform offset.
Eigen::Isometry3d draw_pose(const SceneOptions& scene, std::uint64_t seed) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    if (scene.random_pose) {
        const Random random(seed, kPoseStream);
        const Eigen::Quaterniond q(random.normal(0), random.normal(1), random.normal(2), random.normal(3));
        pose.linear() = q.normalized().toRotationMatrix();
        for (int axis = 0; axis < 3; ++axis) {
            pose.translation()[axis] = random.uniform(10 + axis, -scene.max_offset_mm, scene.max_offset_mm);
        }
    }
    return pose;
}

}  // namespace

Dataset make_dataset(const SceneOptions& scene, const ScannerOptions& scanner, std::uint64_t seed, unsigned threads) {
    if (scanner.organised && scanner.views != 1) {
        throw InputError("dataset: an organised scan of " + std::to_string(scanner.views) +
                         " views was asked for; an organised scan has one raster, so set views to 1");
    }
    Dataset dataset;
    dataset.scene = resolved(scene, seed);
    dataset.scanner = scanner;
    dataset.seed = seed;
    dataset.scan_from_scene = draw_pose(scene, seed);
    const Scene made = make_scene(dataset.scene);
    dataset.truth = transformed(made.truth, dataset.scan_from_scene);
    if (threads == 0) {
        threads = usable_processors();
    }
    for (int i = 0; i < scanner.views; ++i) {
        const View view = take_view(made, scanner, seed, i, threads);
        dataset.views.push_back(
            {dataset.points.size(), dataset.scan_from_scene * view.error * dataset.scan_from_scene.inverse()});
        for (const Eigen::Vector3d& p : view.points) {
            if (!std::isnan(p.x())) {
                dataset.points.emplace_back((dataset.scan_from_scene * p).cast<float>());
            } else if (scanner.organised) {
                dataset.points.emplace_back(Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
            }
        }
        if (scanner.organised) {
            dataset.width = view.width;
            dataset.height = view.height;
        }
    }
    return dataset;
}

}  // namespace seampath
