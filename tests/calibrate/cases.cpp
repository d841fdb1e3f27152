#include "tests/calibrate/cases.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "stages/error.hpp"

namespace seampath {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kRegion95 = 12.592;  // of a chi-squared of 6

/// Calls f(seed, result) for every seed; an InputError is a set that went wrong.
template <class F>
CaseResult over_seeds(std::uint64_t first, int sets, const F& f) {
    CaseResult result;
    for (std::uint64_t seed = first; seed < first + static_cast<std::uint64_t>(sets); ++seed) {
        const int good = result.good;
        try {
            f(seed, result);
        } catch (const InputError& error) {
            result.note = result.note.empty() ? error.what() : result.note;
        }
        ++result.sets;
        if (result.good == good && result.note.empty()) {
            result.note = "seed " + std::to_string(seed);
        }
    }
    result.rms_mm = std::sqrt(result.rms_mm / sets);
    return result;
}

void add_error(CaseResult& result, const Isometry3d& found, const Isometry3d& truth, const Vector3d& at) {
    const double error = (found * at - truth * at).norm();
    result.rms_mm += error * error;
    result.largest_mm = std::max(result.largest_mm, error);
    result.largest_rad = std::max(result.largest_rad, displacement(truth, found).tail<3>().norm());
}

bool in_region(const Isometry3d& found, const Isometry3d& truth, const Matrix6& covariance) {
    const Vector6 d = displacement(found, truth);
    return d.dot(covariance.ldlt().solve(d)) < kRegion95;
}

struct SurfaceSet {
    SurfaceScan seen;
    BestFit fit;
    Vector3d middle;  ///< of the part
};

SurfaceSet surface_set(FixturePart part, std::uint64_t seed, int width) {
    SurfaceScene scene;
    scene.part = part;
    scene.width = width;
    scene.height = static_cast<int>(0.735 * width);
    const PartMesh mesh = part_mesh(part);
    Eigen::AlignedBox3d box;
    for (const Vector3d& p : mesh.vertices) {
        box.extend(p);
    }
    SurfaceSet set{make_surface_scan(scene, seed), {}, box.center()};
    BestFitOptions options;
    options.frame.trials = 1000;
    set.fit = calibrate_surface(set.seen.made.scan, sampled_mesh(mesh, 200000, "nominal"), {{"middle", box.center()}},
                                options);
    return set;
}

// What a part without a pose of its own must be refused for.
bool reason_named(FixturePart part, const FrameResult& r) {
    const bool alike = part == FixturePart::cuboid || part == FixturePart::flange;
    const bool ambiguous = std::any_of(r.faults.begin(), r.faults.end(),
                                       [](const std::string& fault) { return fault.starts_with("ambiguous"); });
    return !r.weak.empty() || (alike && ambiguous);  // a cuboid that shows two faces slides along their edge
}

FrameResult ball_frame(const BallScene& scene, const FixtureScan& made) {
    std::vector<Vector3d> centres;
    const auto found = find_balls(made.scan, scene.diameter_mm / 2);
    for (const FoundBall& ball : found) {
        centres.push_back(ball.centre);
    }
    const auto match = match_balls(scene.balls, centres, 1);
    std::vector<FrameFeature> features;
    for (std::size_t i = 0; i < match.size(); ++i) {
        if (match[i]) {
            const FoundBall& ball = found[*match[i]];
            features.push_back({scene.balls[i].name, 0, false, {{scene.balls[i].p, ball.centre, ball.covariance}}, {}});
        }
    }
    FrameOptions options;
    options.trials = 1000;
    return calibrate_frame(features, {}, options);
}

}  // namespace

CaseResult ball_case(std::uint64_t first, int sets) {
    return over_seeds(first, sets, [](std::uint64_t seed, CaseResult& result) {
        const BallScene scene;
        const FixtureScan made = make_ball_scan(scene, seed);
        const FrameResult r = ball_frame(scene, made);
        add_error(result, r.base_from_part, made.base_from_part, {600, 0, 0});
        result.inside += in_region(r.base_from_part, made.base_from_part, r.covariance);
        result.good += r.features.size() == 4 && r.moved.empty();
    });
}

CaseResult moved_ball_case(std::uint64_t first, int sets) {
    return over_seeds(first, sets, [](std::uint64_t seed, CaseResult& result) {
        BallScene scene;
        scene.moved = scene.balls[seed % 4].name;
        const FrameResult r = ball_frame(scene, make_ball_scan(scene, seed));
        result.good += r.moved == std::vector<std::string>{scene.moved} && !r.pass();
    });
}

CaseResult surface_case(std::uint64_t first, int sets, int width) {
    return over_seeds(first, sets, [&](std::uint64_t seed, CaseResult& result) {
        const auto part = static_cast<FixturePart>(seed % kDefiniteParts);
        const SurfaceSet set = surface_set(part, seed, width);
        const Isometry3d &found = set.fit.frame.base_from_part, &truth = set.seen.made.base_from_part;
        add_error(result, found, truth, set.middle);
        const Vector6 off = displacement(truth, found);
        result.inside += in_region(found, truth, set.fit.frame.covariance);
        const bool near = (found * set.middle - truth * set.middle).norm() <= 0.02 &&
                          off.tail<3>().norm() <= 0.005 * std::numbers::pi / 180;
        result.good += near && set.fit.frame.pass();
        if (!near && set.fit.frame.pass()) {
            result.note = "seed " + std::to_string(seed) + " is wrong, and passed";
        }
    });
}

CaseResult open_surface_case(std::uint64_t first, int sets, int width) {
    return over_seeds(first, sets, [&](std::uint64_t seed, CaseResult& result) {
        constexpr std::size_t kOpenParts = kFixturePartNames.size() - kDefiniteParts;
        const auto part = static_cast<FixturePart>(kDefiniteParts + seed % kOpenParts);
        const SurfaceSet set = surface_set(part, seed, width);
        result.good += !set.fit.frame.pass() && reason_named(part, set.fit.frame);
    });
}

}  // namespace seampath
