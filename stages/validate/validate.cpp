#include "stages/validate/validate.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "stages/error.hpp"
#include "stages/geometry/border_section.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/geometry/parallel.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/geometry/seam_pieces.hpp"
#include "stages/geometry/step_height.hpp"
#include "stages/geometry/views.hpp"
#include "stages/text.hpp"
#include "stages/validate/flank_deviation.hpp"
#include "stages/validate/groove_deviation.hpp"
#include "stages/validate/verdict.hpp"

namespace seampath {
namespace {

using detail::Ground;

constexpr double kLeastTolerance = 0.1;  // mm; tracking accuracy that arc welding asks of a path
constexpr double kMostSigma = 3;         // of the seam's usual sigma; a weaker fit says nothing about the model
constexpr double kGrooveReach = 40;      // mm; tops begin far from the root of a deep groove
constexpr double kLeastDensity = 0.1;    // of the seam's usual density of flank points

// Only scan points near the curve matter: those in cells of the window's size that the curve comes near to.
PointGrid grid_near(const Scan& scan, const ArcLength& arc, double reach) {
    std::vector<Eigen::Vector3f> course;
    const auto count = static_cast<std::size_t>(arc.length() / reach * 2) + 2;
    for (std::size_t i = 0; i <= count; ++i) {
        const double station = arc.length() * static_cast<double>(i) / static_cast<double>(count);
        course.push_back((position(arc.curve(), arc.parameter(station)) - scan.origin_mm).cast<float>());
    }
    const PointGrid near(course, reach);
    std::vector<std::uint8_t> keep(scan.points.size(), 0);
    parallel_for(scan.points.size(), 16384, [&](std::size_t i) {
        const Eigen::Vector3d p = scan.points[i].cast<double>();
        const Eigen::Vector3d box = Eigen::Vector3d::Constant(reach);
        near.for_cells_in_box(p - box, p + box, [&](std::size_t) { keep[i] = 1; });
    });
    return {scan.points, reach / 8, keep};
}

// The middle of what the scale is along the seam: one tolerance and one window for a seam, by the part of the scan it
// lies in.
ScanScale scale_along(const ScaleField& field, const ArcLength& arc, const Eigen::Vector3d& origin) {
    constexpr int kPlaces = 25;
    std::vector<double> spacing, noise;
    for (int i = 0; i < kPlaces; ++i) {
        const ScanScale here =
            field.at(position(arc.curve(), arc.parameter(arc.length() * (i + 0.5) / kPlaces)) - origin);
        spacing.push_back(here.spacing);
        noise.push_back(here.noise);
    }
    return {quantile(spacing, 0.5), quantile(noise, 0.5), field.overall.correlation};
}

using Densities = std::array<double, 2>;  // of points on both surfaces at a sample, per mm^2; 0: not measured

// By the middle of the two top edges: how far the model lies above it stands for both flanks.
Densities measure_butt(const Ground& ground, const SeamModel& model, const ArcLength& arc, DeviationSample& sample) {
    const FlankSample flanks = flanks_at(model, sample.station_mm);
    const Eigen::Vector3d t = tangent(model.curve, arc.parameter(sample.station_mm)), up = flanks.n1 + flanks.n2;
    const Eigen::Vector3d n = (up - up.dot(t) * t).normalized();
    const double half = std::min(0.5 * ground.window.along, 0.25 * arc.length());
    const auto turned = [&](double station) {
        return tangent(model.curve, arc.parameter(std::clamp(station, 0.0, arc.length())));
    };
    const double from = std::max(0.0, sample.station_mm - half), to = std::min(arc.length(), sample.station_mm + half);
    const ViewedPoints points{ground.grid, ground.views};
    GapPlace place{sample.p - ground.origin, t, n, 0, 0, (turned(to) - turned(from)).dot(n.cross(t)) / (to - from)};
    const auto guess = find_gap(points, ground.scale, place, 0.3 * ground.window.along);
    if (!guess) {
        return {0, 0};
    }
    const SectionWindow window = within_bend(ground.window, guess->bend, ground.scale);
    auto fit = settle_gap(points, ground.scale, *guess, window, 2);
    if (!fit) {
        // A gap hardly wider than points are apart is told by few of them: about the model's own middle, then.
        GapPlace narrow = *guess;
        narrow.p = place.p + (guess->p - place.p).dot(n) * n;
        narrow.gap = 1.2 * ground.scale.spacing;
        fit = settle_gap(points, ground.scale, narrow, window, 2);
    }
    if (!fit) {
        return {0, 0};
    }
    Eigen::Vector3d off = place.p - fit->place.p;
    off -= off.dot(t) * t;
    sample.flank1_mm = sample.flank2_mm = off.dot(n);
    sample.distance_mm = off.norm();
    sample.sigma_mm = fit->sigma;
    sample.covered = true;
    return {fit->support[0], fit->support[1]};
}

// Of the plate on top, along the seam.
std::optional<double> wall_height(const Ground& ground, const SeamModel& model, const ArcLength& arc) {
    constexpr int kPlaces = 15;
    std::vector<double> heights;
    for (int i = 0; i < kPlaces; ++i) {
        const double station = arc.length() * (i + 0.5) / kPlaces;
        const FlankSample flanks = flanks_at(model, station);
        const Eigen::Vector3d p = position(model.curve, arc.parameter(station)) - ground.origin;
        if (const auto height = step_height(ground.grid, ground.scale, p, flanks.n1, flanks.n2)) {
            heights.push_back(*height);
        }
    }
    return heights.empty() ? std::nullopt : std::optional(quantile(heights, 0.5));
}

/// What all pieces of a seam are measured against.
struct Measuring {
    const Scan& scan;
    const ScaleField& field;
    const std::vector<std::size_t>& views;
    const ValidateOptions& options;
};

// Samples along a model without corners, and its tolerance.
Deviation measure(const Measuring& by, const SeamModel& model) {
    const ArcLength arc(model.curve);
    const ScanScale scale = scale_along(by.field, arc, by.scan.origin_mm);
    const SectionWindow window = measuring_window(scale);
    const double reach = model.kind == JointKind::v_groove ? kGrooveReach : 1.3 * window.away;
    const PointGrid grid = grid_near(by.scan, arc, reach);
    const auto count =
        std::max<std::size_t>(8, static_cast<std::size_t>(std::lround(arc.length() / (4 * scale.spacing))));
    Deviation result;
    const double asked = by.options.tolerance_mm;
    result.tolerance_mm = asked > 0 ? asked : std::max(kLeastTolerance, detail::kNoiseTolerance * scale.noise);
    result.samples.resize(count);
    const Ground ground{by.scan.origin_mm, grid, by.views, scale, window};
    std::vector<double> density[2];
    density[0].assign(count, 0);
    density[1].assign(count, 0);
    for (std::size_t i = 0; i < count; ++i) {
        DeviationSample& sample = result.samples[i];
        sample.station_mm = arc.length() * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
        sample.p = position(model.curve, arc.parameter(sample.station_mm));
    }
    if (model.kind == JointKind::v_groove) {
        detail::measure_groove_samples(model, arc, by.scan.origin_mm, grid, by.views, scale, result.samples, density);
    } else if (model.kind == JointKind::butt) {
        parallel_for(count, 4, [&](std::size_t i) {
            const auto seen = measure_butt(ground, model, arc, result.samples[i]);
            density[0][i] = seen[0];
            density[1][i] = seen[1];
        });
    } else {
        const std::optional<double> wall =
            model.kind == JointKind::lap ? wall_height(ground, model, arc) : std::nullopt;
        const double noise = detail::measure_flank_samples(ground, model, wall, result.samples, density);
        if (asked == 0 && noise > 0) {
            result.tolerance_mm = std::max(kLeastTolerance, detail::kNoiseTolerance * std::min(noise, scale.noise));
        }
    }
    std::vector<double> sigma;
    for (const DeviationSample& sample : result.samples) {
        if (sample.covered) {
            sigma.push_back(sample.sigma_mm);
        }
    }
    // What is sure to a quarter of the tolerance is a measurement, however much surer the rest of the seam is.
    const double most_sigma = std::max(kMostSigma * quantile(sigma, 0.5), 0.25 * result.tolerance_mm);
    for (DeviationSample& sample : result.samples) {
        sample.covered = sample.covered && sample.sigma_mm <= most_sigma;
    }
    for (const std::vector<double>& d : density) {
        std::vector<double> sorted = d;
        const double least = kLeastDensity * quantile(sorted, 0.5);
        for (std::size_t i = 0; i < count; ++i) {
            result.samples[i].covered = result.samples[i].covered && d[i] > least;
        }
    }
    return result;
}

}  // namespace

Fields describe(ValidateOptions& o) {
    return {
        {"tolerance_mm", &o.tolerance_mm,
         "largest deviation that passes; 0: 3 sigmas of the scan's noise, at least 0.1 mm", at_least(0)},
        {"min_coverage", &o.min_coverage, "least share of the seam that must be measured, not bridged", within(0, 1)}};
}

Deviation validate(const SeamModel& model, const Scan& scan, const ValidateOptions& options) {
    const ScaleField field = estimate_scale(scan.points);
    if (field.overall.spacing <= 0) {
        throw InputError("validate: the scan has " + std::to_string(scan.points.size()) +
                         " points; surfaces were needed; use the scan that the seam came from");
    }
    // An organised cloud is one view.
    const std::vector<std::size_t> views = scan.pixel.empty() ? view_starts(scan.points) : std::vector<std::size_t>{0};
    const Measuring by{scan, field, views, options};
    Deviation result;
    if (model.corners_mm.empty()) {
        result = measure(by, model);
    } else {
        for (const ModelPiece& piece : pieces_of(model)) {
            const Deviation own = measure(by, piece.model);
            result.tolerance_mm =
                result.samples.empty() ? own.tolerance_mm : std::min(result.tolerance_mm, own.tolerance_mm);
            for (DeviationSample sample : own.samples) {
                sample.station_mm += piece.from_mm;
                result.samples.push_back(sample);
            }
        }
    }
    detail::summarise(result, options);
    return result;
}

}  // namespace seampath
