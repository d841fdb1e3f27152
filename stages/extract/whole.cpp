#include "stages/extract/whole.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <Eigen/Dense>

#include "stages/extract/joint.hpp"
#include "stages/extract/registration.hpp"
#include "stages/geometry/parallel.hpp"
#include "stages/geometry/whole_flank.hpp"

namespace seampath::detail {
namespace {

/// A flank of a way, and what shifts of the views do to it.
struct FlankOfWay {
    FlankPool pool;
    FlankFit fit;
    std::vector<ViewShifts::Unknown> shift;  ///< of each place, what stays unknown of the views' shifts
};

FlankOfWay flank_of(const Tracker& tracker, const ViewShifts& shifts, std::size_t number,
                    const std::vector<TrackPoint>& way, double least_scale) {
    const std::size_t k = number % 2;
    std::vector<FlankPlace> places;
    for (const TrackPoint& at : way) {
        places.push_back({at.section.p, k == 0 ? at.section.n1 : at.section.n2, at.flank_sigma[k], at.flank_scale[k],
                          !at.modelled, at.slab[k]});
    }
    const ScanScale scale = tracker.scale_at(way[way.size() / 2].section);
    const double reach = tracker.window_of(scale).along / tracker.step;
    FlankOfWay flank{pool_of(places, static_cast<std::size_t>(std::lround(reach)), scale.correlation), {}, {}};
    flank.fit = fit_whole_flank(places, flank.pool, {flank.pool.reach, least_scale});
    std::optional<ShiftOfSurface> moved;
    if (flank.fit.whole) {
        moved.emplace(flank.fit.whole->surface, flank.pool, shifts.views());
    }
    const std::vector<ViewShares> windows = shares_of_windows(tracker, way, k);
    for (std::size_t i = 0; i < way.size(); ++i) {
        ViewShifts::Unknown unknown = shifts.unknown(number, windows[i]);
        if (moved) {
            const double share = flank.fit.whole->share[i];
            const ViewShifts::Unknown whole = shifts.unknown(number, moved->at(way[i].section.p));
            unknown.by_shift = (1 - share) * unknown.by_shift + share * whole.by_shift;
            unknown.variance = (1 - share) * unknown.variance + share * whole.variance;
        }
        flank.shift.push_back(std::move(unknown));
    }
    return flank;
}

// Moves the place, within its section plane, to where both flanks meet.
void settle(TrackPoint& place, std::size_t i, const std::array<FlankOfWay, 2>& flanks) {
    const Eigen::Vector3d start = place.section.p, own[2] = {place.section.n1, place.section.n2};
    Eigen::Vector3d n[2] = {own[0], own[1]}, p = start;
    for (int round = 0; round < 8; ++round) {
        double off[2];
        for (const std::size_t k : {0u, 1u}) {
            off[k] = own[k].dot(p - start);
            if (const auto& whole = flanks[k].fit.whole) {
                const double share = whole->share[i];
                n[k] = (share * whole->surface.normal(p) + (1 - share) * own[k]).normalized();
                off[k] += share * (whole->surface.distance(p) - whole->at[i].value - off[k]);
            }
        }
        Eigen::Matrix3d A;
        A << n[0].transpose(), n[1].transpose(), place.t.transpose();
        const Eigen::Vector3d step = A.partialPivLu().solve(Eigen::Vector3d(-off[0], -off[1], place.t.dot(start - p)));
        p += step;
        if (step.norm() < 1e-10) {
            break;
        }
    }
    const Eigen::Vector3d axis = n[0].cross(n[1]);
    place.section = {p, n[0], n[1]};
    place.t = axis.normalized();
    place.bend = std::atan2(axis.norm(), n[0].dot(n[1]));
}

// Variance of the place across flank k that the points' noise leaves.
double noise_across(const TrackPoint& place, std::size_t i, std::size_t k, const FlankOfWay& flank) {
    const auto& whole = flank.fit.whole;
    const double share = whole ? whole->share[i] : 0;
    return (1 - share) * std::pow(place.flank_sigma[k], 2) + (whole ? share * whole->at[i].variance : 0);
}

// Of the distance of the place from the seam. Noise is each flank's own; a view's shift, which no fit sees, moves both
// flanks together.
double sigma_of(const TrackPoint& place, std::size_t i, const std::array<FlankOfWay, 2>& flanks,
                const ViewShifts& shifts) {
    double variance = -2 * std::cos(place.bend) * shifts.covariance(flanks[0].shift[i], flanks[1].shift[i]);
    for (const std::size_t k : {0u, 1u}) {
        variance += noise_across(place, i, k, flanks[k]) + flanks[k].shift[i].variance;
    }
    return std::sqrt(std::max(0.0, variance)) / std::max(1e-6, std::sin(place.bend));
}

SeamSurfaces settle_way(const Tracker& tracker, const ViewShifts& shifts, std::size_t first, double registration,
                        std::vector<TrackPoint>& way) {
    const double least_scale = 0.3 * noise_of(tracker.scale_at(way[way.size() / 2].section));
    std::array<FlankOfWay, 2> flanks;
    parallel_for(2, 1, [&](std::size_t k) { flanks[k] = flank_of(tracker, shifts, first + k, way, least_scale); });
    for (std::size_t i = 0; i < way.size(); ++i) {
        if (way[i].modelled && !(flanks[0].fit.whole && flanks[1].fit.whole)) {
            continue;
        }
        settle(way[i], i, flanks);
        way[i].sigma = sigma_of(way[i], i, flanks, shifts);
    }
    const auto pooled = [](const FlankOfWay& flank) {
        const FlankFit& fit = flank.fit;
        return PooledFlank{&flank.pool, fit.nearest ? &*fit.nearest : nullptr, fit.whole.has_value()};
    };
    return joint_surfaces({pooled(flanks[0]), pooled(flanks[1])}, registration, least_scale);
}

}  // namespace

std::vector<SeamSurfaces> settle_on_whole_flanks(std::span<const MeasuredWay> ways, double registration) {
    std::vector<SeamSurfaces> surfaces;
    if (ways.empty()) {
        return surfaces;
    }
    const ViewShifts shifts(ways, registration);
    for (std::size_t w = 0; w < ways.size(); ++w) {
        take_back(ways[w].tracker, shifts, 2 * w, *ways[w].places);
        surfaces.push_back(settle_way(ways[w].tracker, shifts, 2 * w, registration, *ways[w].places));
    }
    return surfaces;
}

}  // namespace seampath::detail
