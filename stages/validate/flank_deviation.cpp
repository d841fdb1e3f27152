#include "stages/validate/flank_deviation.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Dense>

#include "stages/angle.hpp"
#include "stages/geometry/robust.hpp"
#include "stages/geometry/whole_flank.hpp"
#include "stages/validate/flank_windows.hpp"

namespace seampath::detail {
namespace {

using Eigen::Vector3d;

constexpr double kMostTurn = 35 * kDegree;  // of a flank's normal against the model's

/// Where the model lies over one flank at a sample.
struct FlankAt {
    double distance = 0;  ///< mm, signed
    double sigma = 0;     ///< mm
    Vector3d normal;
};

// Places to each side that departures are told by: as few as leave them sure to a quarter of the noise, so that what is
// wrong over a short stretch is not evened out. A line through n points at distances u from the seam is known there to
// their 1-sigma times the root of (1 + mean(u)^2 / var(u)) / n.
std::size_t reach_of(const FlankPool& pool, std::size_t places) {
    constexpr double kSure = 0.25;
    double sum = 0, squares = 0;
    for (const double u : pool.u) {
        sum += u;
        squares += u * u;
    }
    const auto n = static_cast<double>(pool.u.size());
    const double mean = sum / n, variance = std::max(1e-9 * squares / n, squares / n - mean * mean);
    const double needed = pool.correlation * (1 + mean * mean / variance) / (kSure * kSure);
    const double reach = 0.5 * (needed * static_cast<double>(places) / n - 1);
    return static_cast<std::size_t>(std::ceil(std::clamp(reach, 0.0, static_cast<double>(pool.reach))));
}

std::optional<WholeFlank> whole_flank(const Course& course, const std::vector<Window>& windows, std::size_t k,
                                      bool by_windows) {
    constexpr std::size_t kLeastPoints = 30;
    const ScanScale& scale = course.ground.scale;
    std::vector<FlankPlace> places;
    for (const Window& window : windows) {
        FlankPlace place{window.model.p, window.normal(k), 0, noise_of(scale), false, window.slab[k]};
        if (by_windows && is_sure(course, window, k)) {
            const Section& at = window.fit->section;
            const Flank& flank = window.fit->flank[k];
            place = {at.p, k == 0 ? at.n1 : at.n2, flank.sigma, flank.fit.scale(), true, window.slab[k]};
        }
        places.push_back(place);
    }
    const auto along = static_cast<std::size_t>(std::lround(course.ground.window.along / course.step));
    const FlankPool pool = pool_of(places, along, scale.correlation);
    if (pool.points.empty()) {
        return std::nullopt;
    }
    return fit_whole_flank(
               places, pool,
               {reach_of(pool, places.size()), 0.3 * noise_of(scale), kLeastPoints, course.ground.views.size() > 1})
        .whole;
}

// The flank as a whole, when it is one. Points of samples whose own windows see too little are added when the rest of
// the seam has told where the flank is; when hardly any window sees enough, the model says where to look.
std::optional<WholeFlank> settled_flank(const Course& course, std::vector<Window>& windows, std::size_t k) {
    take_slabs(course, windows, k);
    const auto sure = static_cast<std::size_t>(
        std::count_if(windows.begin(), windows.end(), [&](const Window& w) { return is_sure(course, w, k); }));
    if (2 * sure < windows.size()) {
        look_by_model(course, windows, k);
        return whole_flank(course, windows, k, false);
    }
    const SectionWindow extent = usual_extent(course, windows, k);
    auto whole = whole_flank(course, windows, k, true);
    bool added = false;
    for (Window& window : windows) {
        if (whole && !is_sure(course, window, k)) {
            look_on_surface(course, whole->surface, extent, k, window);
            added = true;
        }
    }
    return added ? whole_flank(course, windows, k, true) : whole;
}

FlankAt by_whole(const WholeFlank& whole, const Window& window, std::size_t i) {
    const Vector3d& p = window.model.p;
    return {whole.surface.distance(p) - whole.at[i].value, std::sqrt(whole.at[i].variance), whole.surface.normal(p)};
}

// The surface that one window found of flank k, at a place near to it.
FlankAt by_window(const SectionFit& fit, std::size_t k, const Vector3d& p) {
    const Flank& flank = fit.flank[k];
    const SectionFrame& f = fit.frame;
    const Vector3d v = p - f.p;
    const double u = v.dot(f.d[k]), s = v.dot(f.t);
    const double x = u / flank.window.away, y = s / flank.window.along;
    const auto& c = flank.fit.coefficients();
    const double slope_u = (c[1] + 2 * c[3] * x + c[4] * y) / flank.window.away,
                 slope_s = (c[2] + c[4] * x + 2 * c[5] * y) / flank.window.along;
    const auto row = QuadraticFit::row(x, y);
    const Vector3d normal = f.n[k] - slope_u * f.d[k] - slope_s * f.t;
    return {residual(flank, u, s, v.dot(f.n[k])) / normal.norm(),
            flank.unit * std::sqrt(row.dot(flank.fit.cofactors() * row)), normal.normalized()};
}

// By the windows of the sample and of those beside it, whose surfaces all hold here: their weighted median, so that no
// single one decides. They share most of their points, so that together they are as sure as one of them, or as they
// agree. Where they are few, by the sample's own.
std::optional<FlankAt> by_windows(const Course& course, const std::vector<Window>& windows, std::size_t i,
                                  std::size_t k) {
    constexpr double kNear = 0.25;  // of a window's length to each side
    constexpr std::size_t kFew = 3;
    const auto& own = windows[i].fit;
    const Vector3d& p = windows[i].model.p;
    const double along = own ? own->flank[k].window.along : course.limits[k].along;
    const auto n = static_cast<std::ptrdiff_t>(windows.size()), middle = static_cast<std::ptrdiff_t>(i),
               reach = std::min(static_cast<std::ptrdiff_t>(kNear * along / course.step), n / 2);
    std::vector<FlankAt> near;
    for (std::ptrdiff_t j = middle - reach; j <= middle + reach; ++j) {
        const Window& window = windows[static_cast<std::size_t>((j + n) % n)];
        if ((course.closed || (j >= 0 && j < n)) && window.explains[k]) {
            near.push_back(by_window(*window.fit, k, p));
        }
    }
    if (near.size() < kFew) {
        // One that is not sure says so by its sigma.
        const bool holds = own && (windows[i].explains[k] || !is_sure(course, windows[i], k));
        return holds ? std::optional(by_window(*own, k, p)) : std::nullopt;
    }
    std::sort(near.begin(), near.end(), [](const FlankAt& a, const FlankAt& b) { return a.distance < b.distance; });
    double left = 0;
    for (const FlankAt& at : near) {
        left += 0.5 / (at.sigma * at.sigma);
    }
    const auto found = std::find_if(near.begin(), near.end() - 1, [&](const FlankAt& at) {
        left -= 1 / (at.sigma * at.sigma);
        return left <= 0;
    });
    std::vector<double> sigma, off;
    for (const FlankAt& at : near) {
        sigma.push_back(at.sigma);
        off.push_back(std::abs(at.distance - found->distance));
    }
    FlankAt median = *found;
    median.sigma = std::max(quantile(sigma, 0.5), 1.4826 * quantile(off, 0.5));
    return median;
}

// Of the points of a sample and of those nearby.
double density_at(const Course& course, const std::vector<Window>& windows, std::size_t i, std::size_t k,
                  const SectionWindow& extent) {
    const double about = std::max(2.5 * course.ground.scale.spacing, course.ground.window.along / 8);
    const auto reach = static_cast<std::size_t>(std::lround(about / course.step));
    const std::size_t from = i > reach ? i - reach : 0, to = std::min(windows.size(), i + reach + 1);
    double points = 0;
    for (std::size_t j = from; j < to; ++j) {
        points += static_cast<double>(windows[j].slab[k].size());
    }
    return points / (static_cast<double>(to - from) * course.step) / std::max(1e-9, extent.away - extent.band);
}

// Where the flanks meet, from how far each of them is from the model.
void meet_at(const Course& course, const Window& window, const FlankAt& first, const FlankAt& second,
             DeviationSample& sample) {
    Eigen::Matrix3d A;
    A << first.normal.transpose(), second.normal.transpose(), window.t.transpose();
    sample.flank1_mm = course.outwards * first.distance;
    sample.flank2_mm = course.outwards * second.distance;
    sample.distance_mm = A.partialPivLu().solve(Vector3d(first.distance, second.distance, 0)).norm();
    sample.sigma_mm = std::hypot(first.sigma, second.sigma) / std::max(1e-6, first.normal.cross(second.normal).norm());
    sample.covered =
        std::min(first.normal.dot(window.model.n1), second.normal.dot(window.model.n2)) > std::cos(kMostTurn);
}

// Of the rougher flank.
double noise_about_flanks(const Course& course, const std::vector<Window>& windows) {
    double noise = 0;
    for (const std::size_t k : {0u, 1u}) {
        std::vector<double> scales;
        for (const Window& window : windows) {
            if (is_sure(course, window, k)) {
                scales.push_back(window.fit->flank[k].fit.scale());
            }
        }
        noise = std::max(noise, quantile(scales, 0.5));
    }
    return noise;
}

}  // namespace

double measure_flank_samples(const Ground& ground, const SeamModel& model, const std::optional<double>& wall,
                             std::vector<DeviationSample>& samples, std::vector<double> (&density)[2]) {
    const Course course{
        ground, wall ? beside_wall(ground.scale, ground.window, *wall) : SectionWindows(ground.window, ground.window),
        model.length_mm / static_cast<double>(samples.size()), model.kind == JointKind::corner ? -1.0 : 1.0,
        model.closed};
    std::vector<Window> windows = windows_along(course, model, samples);
    const SectionWindow extent[2] = {usual_extent(course, windows, 0), usual_extent(course, windows, 1)};
    const std::optional<WholeFlank> whole[2] = {settled_flank(course, windows, 0), settled_flank(course, windows, 1)};
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const Window& window = windows[i];
        std::optional<FlankAt> flank[2];
        for (const std::size_t k : {0u, 1u}) {
            const bool explained = whole[k] && whole[k]->taken[i] >= kLeastExplained;
            flank[k] = explained ? by_whole(*whole[k], window, i) : by_windows(course, windows, i, k);
        }
        if (flank[0] && flank[1]) {
            meet_at(course, window, *flank[0], *flank[1], samples[i]);
            for (const std::size_t k : {0u, 1u}) {
                density[k][i] =
                    window.fit ? window.fit->flank[k].slab_points : density_at(course, windows, i, k, extent[k]);
            }
        }
    }
    return noise_about_flanks(course, windows);
}

}  // namespace seampath::detail
