#include "stages/validate/validate.hpp"

#include <algorithm>
#include <cmath>

#include "stages/error.hpp"
#include "stages/geometry/bspline.hpp"
#include "stages/geometry/parallel.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/geometry/section.hpp"
#include "stages/geometry/views.hpp"
#include "stages/text.hpp"
#include "stages/validate/groove_deviation.hpp"

namespace seampath {
namespace {

constexpr double kNoiseTolerance = 3;    // tolerance by default, in sigmas of a single scan point
constexpr double kLeastTolerance = 0.1;  // mm; tracking accuracy that arc welding asks of a path
constexpr double kGuard = 2;             // sigmas of the measurement taken off the tolerance (ISO 14253-1)
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

double signed_distance(const Flank& flank) {
    const auto& c = flank.fit.coefficients();
    const double du = c[1] / flank.window.away, ds = c[2] / flank.window.along;
    return -c[0] / std::sqrt(1 + du * du + ds * ds);
}

void summarise(Deviation& result, const ValidateOptions& options) {
    std::vector<double> distance, sigma;
    double sum = 0, signed_sum = 0;
    for (const DeviationSample& s : result.samples) {
        if (s.covered) {
            distance.push_back(s.distance_mm);
            sigma.push_back(s.sigma_mm);
            sum += s.distance_mm * s.distance_mm;
            signed_sum += 0.5 * (s.flank1_mm + s.flank2_mm);
        }
    }
    const auto n = static_cast<double>(distance.size());
    result.coverage = result.samples.empty() ? 0 : n / static_cast<double>(result.samples.size());
    if (!distance.empty()) {
        result.signed_mean_mm = signed_sum / n;
        result.rms_mm = std::sqrt(sum / n);
        result.p50_mm = quantile(distance, 0.5);
        result.p95_mm = quantile(distance, 0.95);
        result.p997_mm = quantile(distance, 0.997);
        result.max_mm = quantile(distance, 1);
    }
    const double guarded = result.p997_mm + kGuard * quantile(sigma, 0.5);
    const bool covered = result.coverage >= options.min_coverage, inside = guarded <= result.tolerance_mm;
    result.pass = covered && inside && !distance.empty();
    result.verdict = std::string(result.pass ? "pass" : "fail") + ": p99.7 " + fixed(result.p997_mm, 3) +
                     " mm + guard " + fixed(guarded - result.p997_mm, 3) + " mm " + (inside ? "within" : "exceeds") +
                     " tolerance " + fixed(result.tolerance_mm, 3) + " mm; " + fixed(100 * result.coverage, 1) +
                     " % of the seam measured" +
                     (covered ? "" : ", less than " + fixed(100 * options.min_coverage, 1) + " %");
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
    const ArcLength arc(model.curve);
    const ScanScale scale = scale_along(field, arc, scan.origin_mm);
    const SectionWindow window = measuring_window(scale);
    const double reach = model.kind == JointKind::v_groove ? kGrooveReach : 1.3 * window.away;
    const PointGrid grid = grid_near(scan, arc, reach);
    const auto count =
        std::max<std::size_t>(8, static_cast<std::size_t>(std::lround(arc.length() / (4 * scale.spacing))));
    Deviation result;
    result.tolerance_mm =
        options.tolerance_mm > 0 ? options.tolerance_mm : std::max(kLeastTolerance, kNoiseTolerance * scale.noise);
    result.samples.resize(count);
    // A corner is measured inside out: from within the material it is concave.
    const double outwards = model.kind == JointKind::corner ? -1 : 1;
    std::vector<double> density[2];
    density[0].assign(count, 0);
    density[1].assign(count, 0);
    for (std::size_t i = 0; i < count; ++i) {
        DeviationSample& sample = result.samples[i];
        sample.station_mm = arc.length() * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
        sample.p = position(model.curve, arc.parameter(sample.station_mm));
    }
    if (model.kind == JointKind::v_groove) {
        // An organised cloud is one view.
        const std::vector<std::size_t> views =
            scan.pixel.empty() ? view_starts(scan.points) : std::vector<std::size_t>{0};
        detail::measure_groove_samples(model, arc, scan.origin_mm, grid, views, scale, result.samples, density);
    } else {
        parallel_for(count, 4, [&](std::size_t i) {
            DeviationSample& sample = result.samples[i];
            const FlankSample flanks = flanks_at(model, sample.station_mm);
            const auto fit = fit_section(
                grid, scale, {sample.p - scan.origin_mm, outwards * flanks.n1, outwards * flanks.n2}, window);
            if (fit) {
                sample.flank1_mm = outwards * signed_distance(fit->flank[0]);
                sample.flank2_mm = outwards * signed_distance(fit->flank[1]);
                sample.distance_mm = fit->shift;
                sample.sigma_mm = fit->sigma;
                sample.covered = true;
                density[0][i] = fit->flank[0].slab_points;
                density[1][i] = fit->flank[1].slab_points;
            }
        });
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
    summarise(result, options);
    return result;
}

}  // namespace seampath
