#include "tests/accuracy/measure.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "stages/fit/fit.hpp"
#include "stages/place/place.hpp"
#include "stages/text.hpp"
#include "stages/validate/validate.hpp"
#include "tests/accuracy/common_error.hpp"

namespace seampath {
namespace {

using Eigen::Vector3d;

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Distance across the nearest true seam; infinite where none is near.
double radial_distance(const Truth& truth, const Vector3d& p) {
    double nearest = kCorrespondence * kCorrespondence;
    double radial = std::numeric_limits<double>::infinity();
    for (const TruthSeam& seam : truth.seams) {
        for (const TruthPoint& point : seam.points) {
            const Vector3d d = p - point.p;
            if (d.squaredNorm() < nearest) {
                nearest = d.squaredNorm();
                radial = (d - d.dot(point.tangent) * point.tangent).norm();
            }
        }
    }
    return radial;
}

void compare_with_sigma(const std::vector<Seam>& seams, const Truth& truth, Accuracy& accuracy) {
    std::size_t near = 0, one = 0, two = 0;
    for (const Seam& seam : seams) {
        for (const SeamPoint& point : seam.points) {
            const double error = radial_distance(truth, point.p);
            near += std::isfinite(error);
            one += error < point.sigma_mm;
            two += error < 2 * point.sigma_mm;
        }
    }
    accuracy.within_1_sigma = near ? static_cast<double>(one) / static_cast<double>(near) : 0;
    accuracy.within_2_sigma = near ? static_cast<double>(two) / static_cast<double>(near) : 0;
}

/// Whether a model lies where there is no seam, or is off by more than that.
bool is_wrong(const SeamModel& model, const Truth& truth, double tolerance_mm) {
    constexpr double kSeen = 0.02;  // of the length; ends may reach too far
    const Score own = score(std::span(&model, 1), truth);
    return own.max_mm > tolerance_mm || (own.false_share > kSeen && tolerance_mm < kCorrespondence);
}

}  // namespace

Scan scan_of(const Dataset& dataset) {
    Scan scan;
    scan.name = name(dataset.scene.kind);
    for (const Eigen::Vector3f& p : dataset.points) {
        if (p.allFinite()) {
            scan.points.push_back(p);
        }
    }
    scan.points_in_file = dataset.points.size();
    scan.dropped_not_finite = dataset.points.size() - scan.points.size();
    return scan;
}

Accuracy measure_accuracy(const Dataset& dataset, const ExtractOptions& options) {
    Accuracy a;
    a.scene = dataset.scene.kind;
    a.seed = dataset.seed;
    const Scan scan = scan_of(dataset);
    const auto start = std::chrono::steady_clock::now();
    const Extraction extraction = extract(scan, options);
    a.extract_s = seconds_since(start);
    std::vector<SeamModel> models;
    for (const Seam& seam : extraction.seams) {
        models.push_back(fit(seam, place(seam, {}), {}));
        const Deviation deviation = validate(models.back(), scan, {});
        a.validated_rms_mm = std::max(a.validated_rms_mm, deviation.rms_mm);
        a.least_coverage = std::min(a.least_coverage, deviation.coverage);
        a.passed += deviation.pass;
        a.passed_wrong += deviation.pass && is_wrong(models.back(), dataset.truth, deviation.tolerance_mm);
        if (models.back().saddle) {
            a.saddles.push_back(*models.back().saddle);
        }
    }
    a.stages_s = seconds_since(start);
    a.points = scan.points.size();
    a.seams = extraction.seams.size();
    a.true_seams = dataset.truth.seams.size();
    a.extracted = score(extraction.seams, dataset.truth);
    a.fitted = score(models, dataset.truth);
    const Truth moved = moved_with_views(dataset);
    a.common_mm = common_error(dataset.truth, moved);
    a.extracted_apart = score(extraction.seams, moved);
    a.fitted_apart = score(models, moved);
    compare_with_sigma(extraction.seams, dataset.truth, a);
    return a;
}

double worst_end(const Score& score) {
    const auto& ends = score.end_errors_mm;
    return ends.empty() ? 0 : *std::max_element(ends.begin(), ends.end());
}

std::vector<std::string> missed(const Accuracy& accuracy, const AccuracyLimits& limits) {
    std::vector<std::string> misses;
    const auto at_most = [&](const std::string& what, double value, double limit) {
        if (!(value <= limit)) {
            misses.push_back(what + " " + fixed(value, 4) + " > " + fixed(limit, 3));
        }
    };
    const auto hold = [&](const std::string& of, const Score& score) {
        at_most(of + " rms", score.rms_mm, limits.rms_mm);
        at_most(of + " max", score.max_mm, limits.max_mm);
        at_most(of + " not found", 1 - score.found, 1 - limits.found);
        at_most(of + " false", score.false_share, limits.false_share);
        at_most(of + " end", worst_end(score), limits.end_mm);
    };
    hold("extracted", accuracy.extracted);
    hold("fitted", accuracy.fitted);
    return misses;
}

}  // namespace seampath
