#include "tests/calibrate/cases.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/fixtures/fixture_draws.hpp"
#include "stages/error.hpp"
#include "stages/optics/optics.hpp"

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
    const double measured = std::max(1, result.measured);
    result.rms_mm = std::sqrt(result.rms_mm / measured);
    result.sigma_mm = std::sqrt(result.sigma_mm / measured);
    return result;
}

// What the frame found is off, against the truth and its own covariance.
void measure(CaseResult& result, const FrameResult& found, const Isometry3d& truth, const Vector3d& at) {
    const Vector6 d = displacement(found.base_from_part, truth);
    const double error = (found.base_from_part * at - truth * at).norm();
    ++result.measured;
    result.rms_mm += error * error;
    result.sigma_mm += covariance_at(found.covariance, found.base_from_part, at).trace();
    result.largest_mm = std::max(result.largest_mm, error);
    result.largest_rad = std::max(result.largest_rad, d.tail<3>().norm());
    result.inside += d.dot(found.covariance.ldlt().solve(d)) < kRegion95;
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

FrameResult touched_points_frame(const TouchedPart& part, Touched kind, const FrameOptions& options) {
    std::vector<std::string> names;
    std::vector<Vector3d> nominal, measured;
    std::vector<FrameFeature> features;
    for (std::size_t i = 0; i < part.points.size(); ++i) {
        names.push_back("P" + std::to_string(i + 1));
        nominal.push_back(part.points[i].nominal);
        measured.push_back(part.points[i].measured);
        features.push_back({names.back(), 0, false, {part.points[i]}, {}});
    }
    return kind == Touched::points ? calibrate_frame(features, {}, options)
                                   : calibrate_frame(three_point_features(names, part.points), {}, options,
                                                     rigid_through(nominal, measured));
}

/// A scan laid on a golden one, and the truth.
struct GoldenSet {
    BestFit fit;
    Isometry3d truth;
    Vector3d middle;  ///< of the part

    bool near() const {
        const Isometry3d& found = fit.frame.base_from_part;
        return (found * middle - truth * middle).norm() <= 0.1 &&
               displacement(truth, found).tail<3>().norm() <= 0.05 * std::numbers::pi / 180;
    }
};

GoldenSet golden_set(SurfaceScene scene, std::uint64_t seed) {
    scene.height = static_cast<int>(0.735 * scene.width);
    const SurfaceScan seen = make_surface_scan(scene, seed);
    const Scan nominal = golden_scan(make_surface_scan(scene, seed + 1000));
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3f& p : nominal.points) {
        box.extend(p.cast<double>());
    }
    GoldenSet set{{}, seen.made.base_from_part, box.center()};
    BestFitOptions options;
    options.frame.trials = 1000;
    Draws guess(seed, 977);
    options.near = set.truth * Eigen::Translation3d(set.middle + 20 * guess.direction()) *
                   Eigen::AngleAxisd(guess.uniform(0, 0.5), guess.direction()) * Eigen::Translation3d(-set.middle);
    set.fit = calibrate_surface(seen.made.scan, nominal, {{"middle", set.middle}}, options);
    return set;
}

}  // namespace

CaseResult ball_case(std::uint64_t first, int sets) {
    return over_seeds(first, sets, [](std::uint64_t seed, CaseResult& result) {
        const BallScene scene;
        const FixtureScan made = make_ball_scan(scene, seed);
        const FrameResult r = ball_frame(scene, made);
        measure(result, r, made.base_from_part, {600, 0, 0});
        result.good += r.features.size() == 4 && r.moved.empty();
    });
}

CaseResult touched_case(Touched kind, std::uint64_t first, int sets) {
    return over_seeds(first, sets, [kind](std::uint64_t seed, CaseResult& result) {
        const TouchedPart part = make_touched_part(seed);
        FrameOptions options;
        options.trials = 1000;
        const FrameResult r = kind == Touched::planes ? calibrate_planes(part.planes, {}, options)
                                                      : touched_points_frame(part, kind, options);
        measure(result, r, part.base_from_part, {600, 0, 0});
        result.good += r.pass();
    });
}

CaseResult probed_case(std::uint64_t first, int sets) {
    return over_seeds(first, sets, [](std::uint64_t seed, CaseResult& result) {
        ProbedPart part = make_probed_part(seed);
        ProbeOptions probes;
        probes.near = part.near;
        probe_planes(part.scan, part.planes, probes);
        FrameOptions options;
        options.trials = 1000;
        const FrameResult r = calibrate_planes(part.planes, {}, options);
        measure(result, r, part.base_from_part, {300, 0, 0});
        result.good += r.pass();
    });
}

CaseResult board_case(std::uint64_t first, int sets) {
    return over_seeds(first, sets, [](std::uint64_t seed, CaseResult& result) {
        const SeenBoard made = make_seen_board(seed);
        const BoardPlace place = locate_board(made.camera, {"board", made.points}, 0);
        const std::vector<Vector3d> corners{{0, 0, 0}, {150, 0, 0}, {150, 105, 0}, {0, 105, 0}};
        FrameOptions options;
        options.trials = 1000;
        const FrameResult r = calibrate_frame(
            {{"board", 0, false, {}, {}, {{made.part_from_board, place.camera_from_board, place.covariance, corners}}}},
            {}, options);
        measure(result, r, made.camera_from_part, {300, 0, 0});
        result.good += r.pass();
    });
}

CaseResult seam_case(std::uint64_t first, int sets) {
    return over_seeds(first, sets, [](std::uint64_t seed, CaseResult& result) {
        const SeamScene scene;
        const MeasuredSeams made = make_measured_seams(scene, seed);
        FrameOptions options;
        options.trials = 1000;
        const FrameResult r = calibrate_seams(scene.seams, made.seams, {}, options);
        measure(result, r, made.base_from_part, {400, 0, 0});
        result.good += r.pass();
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
        measure(result, set.fit.frame, truth, set.middle);
        const Vector6 off = displacement(truth, found);
        const bool near = (found * set.middle - truth * set.middle).norm() <= 0.02 &&
                          off.tail<3>().norm() <= 0.005 * std::numbers::pi / 180;
        result.good += near && set.fit.frame.pass();
        if (!near && set.fit.frame.pass()) {
            result.note = "seed " + std::to_string(seed) + " is wrong, and passed";
        }
    });
}

CaseResult golden_case(std::uint64_t first, int sets, int width) {
    return over_seeds(first, sets, [&](std::uint64_t seed, CaseResult& result) {
        SurfaceScene scene;
        scene.part = static_cast<FixturePart>(seed % kFixturePartNames.size());
        scene.width = width;
        const GoldenSet set = golden_set(scene, seed);
        const bool passed = set.fit.frame.pass();
        result.good += !passed || set.near();
        if (passed) {
            measure(result, set.fit.frame, set.truth, set.middle);
        }
        if (passed && !set.near()) {
            result.note += (result.note.empty() ? "wrong, and passed: seed " : ", ") + std::to_string(seed);
        }
    });
}

CaseResult same_side_case(std::uint64_t first, int sets, int width) {
    return over_seeds(first, sets, [&](std::uint64_t seed, CaseResult& result) {
        SurfaceScene scene;
        scene.part = static_cast<FixturePart>(seed % kDefiniteParts);
        scene.width = width;
        scene.quarter = static_cast<int>(seed / kDefiniteParts % 4);
        const GoldenSet set = golden_set(scene, seed);
        const bool right = set.fit.frame.pass() && set.near();
        result.good += right;
        if (set.fit.frame.pass()) {
            measure(result, set.fit.frame, set.truth, set.middle);
        }
        if (!right) {
            result.note += (result.note.empty() ? "seed " : "; seed ") + std::to_string(seed) + ": " +
                           (set.fit.frame.pass() ? "wrong, and passed" : set.fit.frame.faults.front());
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
