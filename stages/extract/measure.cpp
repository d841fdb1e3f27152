#include "stages/extract/measure.hpp"

#include <algorithm>
#include <cmath>

#include "stages/extract/ends.hpp"
#include "stages/extract/equal_steps.hpp"
#include "stages/extract/jumps.hpp"
#include "stages/geometry/parallel.hpp"
#include "stages/geometry/robust.hpp"

namespace seampath::detail {
namespace {

constexpr std::size_t kLeastPlaces = 6;  // fewer carry no curve

std::vector<TrackPoint> at_equal_steps(const Track& track, double step) {
    return equal_steps(
        track.points, track.closed, step, [](const TrackPoint& p) -> const Eigen::Vector3d& { return p.section.p; },
        [](const TrackPoint& a, const TrackPoint& b, double x) {
            TrackPoint place = x < 0.5 ? a : b;
            place.section = {(1 - x) * a.section.p + x * b.section.p,
                             ((1 - x) * a.section.n1 + x * b.section.n1).normalized(),
                             ((1 - x) * a.section.n2 + x * b.section.n2).normalized()};
            return place;
        });
}

// Each place measured anew. A bridged place stays as it was modelled unless both flanks turn out to be there after all.
std::vector<std::optional<TrackPoint>> measure_places(const Tracker& following, const Tracker& tracker,
                                                      const std::vector<TrackPoint>& places, bool closed) {
    std::vector<double> support[2];
    for (const TrackPoint& place : places) {
        if (!place.modelled) {
            support[0].push_back(place.support[0]);
            support[1].push_back(place.support[1]);
        }
    }
    const double least[2] = {0.1 * quantile(support[0], 0.5), 0.1 * quantile(support[1], 0.5)};
    std::vector<std::optional<TrackPoint>> measured(places.size());
    const auto good = [&](const std::optional<TrackPoint>& point, const TrackPoint& place) {
        return point && !unsure(tracker, *point) &&
               (point->section.p - place.section.p).norm() < tracker.step + 3 * tracker.scale_at(place.section).noise &&
               (!place.modelled || (point->support[0] >= least[0] && point->support[1] >= least[1]));
    };
    const auto straight = [&](bool front) {
        const Section& end = front ? places.front().section : places.back().section;
        return !closed && straight_end(places, front, 2 * tracker.window_at(end).along, tracker.scale_at(end).noise);
    };
    const bool straight_front = straight(true), straight_back = straight(false);
    parallel_for(places.size(), 4, [&](std::size_t i) {
        const double along = tracker.window_at(places[i].section).along;
        double to_end = along;
        if (straight_front) {
            to_end = std::min(to_end, static_cast<double>(i) * tracker.step);
        }
        if (straight_back) {
            to_end = std::min(to_end, static_cast<double>(places.size() - 1 - i) * tracker.step);
        }
        measured[i] = measure_near_end(tracker, places[i].section, to_end);
        if (!good(measured[i], places[i])) {
            measured[i] = following.measure(places[i].section, 3);  // a narrow place: what followed it can measure it
        }
        if (!good(measured[i], places[i])) {
            measured[i] = places[i].modelled ? std::optional(places[i]) : std::nullopt;
        }
    });
    return measured;
}

// Without the places whose sigma stands out from their neighbours': they saw something else.
std::vector<TrackPoint> without_outliers(const std::vector<std::optional<TrackPoint>>& measured) {
    constexpr std::size_t kNeighbours = 12;
    constexpr double kStandsOut = 4;
    std::vector<TrackPoint> way;
    for (std::size_t i = 0; i < measured.size(); ++i) {
        std::vector<double> sigma;
        for (std::size_t j = i > kNeighbours ? i - kNeighbours : 0; j < std::min(measured.size(), i + kNeighbours + 1);
             ++j) {
            if (measured[j]) {
                sigma.push_back(measured[j]->sigma);
            }
        }
        if (measured[i] && (measured[i]->modelled || measured[i]->sigma <= kStandsOut * quantile(sigma, 0.5))) {
            way.push_back(*measured[i]);
        }
    }
    return way;
}

// A joint has two smooth flanks wider than its own corner, and lies where its points say. Noise, facets and layers of a
// badly fused scan make creases too, but narrow or rough ones, or such that jump from point to point by more than they
// are sure of.
bool is_joint(const Tracker& tracker, const std::vector<TrackPoint>& way, std::size_t places) {
    constexpr double kLeastWidth = 10, kMostRough = 1.8, kMostJump = 6;
    // The angle of a low wall is known from all of it, once it is a joint: its places may be less sure by themselves.
    const double most_unsure = tracker.wall ? 2 : 1;
    std::vector<double> away, rough, unsure, jump, sigma;  // the first in spacings, the next two in noises
    for (std::size_t i = 1; i + 2 < way.size(); ++i) {
        if (!way[i].modelled) {
            // Across the seam only: places may lie closer or further apart along it. Third differences leave out what a
            // bend of the seam makes of second ones; of noise they are larger by the root of 20 / 6.
            const Eigen::Vector3d d =
                way[i + 2].section.p - way[i - 1].section.p + 3 * (way[i].section.p - way[i + 1].section.p);
            jump.push_back(std::sqrt(0.3) * (d - d.dot(way[i].t) * way[i].t).norm());
            away.push_back(way[i].away / tracker.scale_at(way[i].section).spacing);
            rough.push_back(way[i].rough);
            unsure.push_back(way[i].sigma / noise_of(tracker.scale_at(way[i].section)));
            sigma.push_back(std::max(way[i].sigma, 0.02 * tracker.scale_at(way[i].section).spacing));
        }
    }
    return way.size() >= kLeastPlaces && 2 * way.size() > places && quantile(away, 0.5) >= kLeastWidth &&
           quantile(rough, 0.5) <= kMostRough && quantile(unsure, 0.5) <= most_unsure &&
           quantile(jump, 0.5) <= kMostJump * quantile(sigma, 0.5);
}

}  // namespace

std::optional<std::vector<TrackPoint>> measure_track(const Tracker& following, const Track& track) {
    Tracker tracker = following;
    tracker.window_of = measuring_window;
    const std::vector<TrackPoint> places = at_equal_steps(track, tracker.step);
    std::vector<TrackPoint> way =
        without_jumps(without_outliers(measure_places(following, tracker, places, track.closed)), track.closed);
    if (!is_joint(tracker, way, places.size())) {
        return std::nullopt;
    }
    if (!track.closed && way.size() > 8) {
        place_end(tracker, way, false);
        place_end(tracker, way, true);
    }
    return way.size() < kLeastPlaces ? std::nullopt : std::optional(std::move(way));
}

}  // namespace seampath::detail
