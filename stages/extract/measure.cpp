#include "stages/extract/measure.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "stages/extract/whole.hpp"
#include "stages/geometry/parallel.hpp"
#include "stages/geometry/robust.hpp"

namespace seampath::detail {
namespace {

constexpr std::size_t kLeastPlaces = 6;  // fewer carry no curve

// Places at equal distances, along the polyline of the track; open tracks keep both ends.
std::vector<TrackPoint> equal_steps(const Track& track, double step) {
    std::vector<TrackPoint> way = track.points;
    if (track.closed) {
        way.push_back(way.front());
    }
    std::vector<double> station(way.size(), 0);
    for (std::size_t i = 1; i < way.size(); ++i) {
        station[i] = station[i - 1] + (way[i].section.p - way[i - 1].section.p).norm();
    }
    const auto count = std::max<std::size_t>(3, static_cast<std::size_t>(std::lround(station.back() / step)));
    std::vector<TrackPoint> places;
    for (std::size_t k = 0, i = 1; k < count + (track.closed ? 0 : 1); ++k) {
        const double s = station.back() * static_cast<double>(k) / static_cast<double>(count);
        while (i + 1 < way.size() && station[i] < s) {
            ++i;
        }
        const double x = std::clamp((s - station[i - 1]) / std::max(1e-12, station[i] - station[i - 1]), 0.0, 1.0);
        const Section &a = way[i - 1].section, &b = way[i].section;
        TrackPoint place = x < 0.5 ? way[i - 1] : way[i];
        place.section = {(1 - x) * a.p + x * b.p, ((1 - x) * a.n1 + x * b.n1).normalized(),
                         ((1 - x) * a.n2 + x * b.n2).normalized()};
        places.push_back(place);
    }
    return places;
}

// Where a stretch of points ends that holds `density` points per mm up to distance 0; `ahead`: distances beyond it. The
// end is the likeliest change from that density to that of stray points: each point speaks for going on, each mm
// without points against it. A hole is passed when the surface goes on behind it, and where four views become one the
// surface goes on.
double end_of(std::vector<double>& ahead, double density) {
    constexpr double kStray = 0.01;  // density of stray points over that of the surface
    const double cost = density * (1 - kStray) / -std::log(kStray);
    std::sort(ahead.begin(), ahead.end());
    double end = 0, best = 0;
    for (std::size_t i = 0; i < ahead.size(); ++i) {
        const double gain = static_cast<double>(i + 1) - cost * ahead[i];
        if (gain > best) {
            best = gain;
            end = ahead[i];
        }
    }
    return end;
}

constexpr std::size_t kStrips = 6;

// The straight line through y at x = first, first + step, ..., read at x = 0: medians of slopes and of intercepts
// (Theil and Sen), so that a strip that a hole has cut short does not bend it.
double value_at_zero(const std::array<double, kStrips>& y, double first, double step) {
    std::vector<double> slope, intercept;
    for (std::size_t i = 0; i < kStrips; ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            slope.push_back((y[i] - y[j]) / (step * static_cast<double>(i - j)));
        }
    }
    const double b = quantile(slope, 0.5);
    for (std::size_t i = 0; i < kStrips; ++i) {
        intercept.push_back(y[i] - b * (first + step * static_cast<double>(i)));
    }
    return quantile(intercept, 0.5);
}

// How far ahead of an inner place, in the given direction, the shorter of its two flanks reaches at the seam; mm. A
// flank may end at a slant: the ends of strips at growing distance from the seam are carried on to the seam by a
// straight line.
double reach_ahead(const Tracker& tracker, const TrackPoint& place, double direction, double look) {
    const ScanScale scale = tracker.scale_at(place.section);
    const auto fit = fit_section(tracker.grid, scale, place.section, tracker.window_of(scale));
    if (!fit) {
        return 0;
    }
    const Section& at = place.section;
    const Eigen::Vector3d along = at.n1.cross(at.n2).normalized(), ahead = direction * along;
    const Eigen::Vector3d d[2] = {along.cross(at.n1), at.n2.cross(along)}, n[2] = {at.n1, at.n2};
    double reach = look;
    for (int k = 0; k < 2; ++k) {
        const Flank& flank = fit->flank[k];
        // Near the seam: a slanted end must still lie ahead in every strip.
        const double spacing =
            1 / std::sqrt(std::max(1e-12, flank.slab_points));  // of this flank: fewer views may see it
        const double near = flank.window.band, strip = std::min(flank.window.away - near, 16 * spacing) / kStrips;
        std::array<std::vector<double>, kStrips> s;
        std::array<double, kStrips> density{};
        const double behind = std::min(flank.window.along, look);
        tracker.grid.for_points_in_ball(
            at.p, std::hypot(near + kStrips * strip, look), [&](const Eigen::Vector3f& q, double) {
                const Eigen::Vector3d v = q.cast<double>() - at.p;
                const double x = v.dot(ahead), u = v.dot(d[k]);
                if (x >= -behind && x <= look && u >= near && u < near + kStrips * strip) {
                    if (std::abs(residual(flank, u, direction * x, v.dot(n[k]))) <= gate(flank, u, x)) {
                        const auto i = static_cast<std::size_t>((u - near) / strip);
                        if (x > 0) {
                            s[i].push_back(x);
                        } else {
                            density[i] += 1 / behind;
                        }
                    }
                }
            });
        std::array<double, kStrips> end;
        for (std::size_t i = 0; i < kStrips; ++i) {
            end[i] = end_of(s[i], density[i]);
        }
        reach = std::min(reach, value_at_zero(end, near + 0.5 * strip, strip));
    }
    return reach;
}

// Whether the way runs straight, as far as noise lets it be seen, from its front or back over `length` mm.
bool straight_end(const std::vector<TrackPoint>& way, bool front, double length, double noise) {
    const auto at = [&](std::size_t i) -> const Eigen::Vector3d& {
        return way[front ? i : way.size() - 1 - i].section.p;
    };
    std::size_t far = 0;
    while (far + 1 < way.size() && (at(far) - at(0)).norm() < length) {
        ++far;
    }
    const Eigen::Vector3d chord = (at(far) - at(0)).normalized();
    for (std::size_t i = 0; i < far; ++i) {
        const Eigen::Vector3d d = at(i) - at(0);
        if ((d - d.dot(chord) * chord).norm() > 4 * noise) {
            return false;
        }
    }
    return true;
}

// Towards a straight end the window finds flanks on one side only: it keeps their length by reaching further that way.
// Else the place at the end, where the fit is carried on, would be the worst measured of all. Beside a bent end flanks
// bend too, in ways that the fit does not know so far away.
Tracker near_end(const Tracker& tracker, double to_end, double along) {
    Tracker longer = tracker;
    longer.reach_further = std::max(0.0, along - to_end);
    return longer;
}

// Shortens or lengthens one end so that it lies where the first flank ends. Judged from a few steps inside, where both
// flanks are whole: fits at the end itself have data on one side only.
void place_end(const Tracker& tracker, std::vector<TrackPoint>& way, bool front) {
    constexpr std::size_t kInside = 4, kMostWeak = 3;
    if (front) {
        std::reverse(way.begin(), way.end());
    }
    // Places that saw much less than those a little further in, through a hole or with no flank ahead, are no end to
    // carry on.
    const auto weak = [&] { return way.back().modelled || way.back().sigma > 2 * way[way.size() - 1 - kInside].sigma; };
    for (std::size_t k = 0; k < kMostWeak && way.size() > 2 * kInside && weak(); ++k) {
        way.pop_back();
    }
    const TrackPoint inner = way[way.size() - 1 - kInside];
    const double direction = front ? -1 : 1;
    const double look = 3 * static_cast<double>(kInside) * tracker.step + tracker.window_at(inner.section).along;
    const double spacing = tracker.scale_at(inner.section).spacing;
    // A point distance short of the edge: no torch should be sent over it.
    const double reach = reach_ahead(tracker, inner, direction, look) - spacing;
    const auto ahead = [&](const TrackPoint& p) { return direction * (p.section.p - inner.section.p).dot(inner.t); };
    // The last point lies a point distance or two, of a flank that fewer views see, before the end of the look.
    if (reach + 4 * spacing >= look || reach > ahead(way.back()) + (kMostWeak + 1.5) * tracker.step) {
        // The flanks go on: following ended for another reason, and that reason stands. Nothing is carried on far.
        if (front) {
            std::reverse(way.begin(), way.end());
        }
        return;
    }
    while (way.size() > 4 && ahead(way.back()) > reach - 0.5 * tracker.step) {
        way.pop_back();
    }
    const TrackPoint& last = way.back();
    const double rest = (reach - ahead(last)) / std::max(0.3, last.t.dot(inner.t));
    const Section guess = carry_on(way, direction, rest);
    const double along = tracker.window_at(guess).along;
    const bool straight = straight_end(way, false, 2 * along, tracker.scale_at(guess).noise);
    auto end = near_end(tracker, straight ? 0 : along, along).measure(guess, 3);
    if (!end || end->sigma > 2 * last.sigma || (end->section.p - guess.p).norm() > 3 * last.sigma) {
        end = last;
        end->section = guess;
        end->sigma *= 2;
    }
    way.push_back(*end);
    if (front) {
        std::reverse(way.begin(), way.end());
    }
}

// Hundreds of points that leave the seam less sure than two scan points do not see two surfaces: fits shrink to that in
// the smooth valleys of bent or badly fused parts.
bool unsure(const Tracker& tracker, const TrackPoint& point) {
    return point.sigma > 2 * noise_of(tracker.scale_at(point.section));
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
        measured[i] = near_end(tracker, to_end, along).measure(places[i].section, 3);
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
    constexpr double kLeastWidth = 10, kMostRough = 1.8, kMostJump = 6, kMostUnsure = 1;
    std::vector<double> away, rough, unsure, jump, sigma;  // the first in spacings, the next two in noises
    for (std::size_t i = 1; i + 1 < way.size(); ++i) {
        if (!way[i].modelled) {
            // Across the seam only: places may lie closer or further apart along it.
            const Eigen::Vector3d d = way[i - 1].section.p - 2 * way[i].section.p + way[i + 1].section.p;
            jump.push_back((d - d.dot(way[i].t) * way[i].t).norm());
            away.push_back(way[i].away / tracker.scale_at(way[i].section).spacing);
            rough.push_back(way[i].rough);
            unsure.push_back(way[i].sigma / noise_of(tracker.scale_at(way[i].section)));
            sigma.push_back(std::max(way[i].sigma, 0.02 * tracker.scale_at(way[i].section).spacing));
        }
    }
    return way.size() >= kLeastPlaces && 2 * way.size() > places && quantile(away, 0.5) >= kLeastWidth &&
           quantile(rough, 0.5) <= kMostRough && quantile(unsure, 0.5) <= kMostUnsure &&
           quantile(jump, 0.5) <= kMostJump * quantile(sigma, 0.5);
}

}  // namespace

std::optional<Seam> measure_track(const Tracker& following, const Track& track, const Eigen::Vector3d& origin) {
    Tracker tracker = following;
    tracker.window_of = measuring_window;
    const std::vector<TrackPoint> places = equal_steps(track, tracker.step);
    std::vector<TrackPoint> way = without_outliers(measure_places(following, tracker, places, track.closed));
    if (!is_joint(tracker, way, places.size())) {
        return std::nullopt;
    }
    if (!track.closed && way.size() > 8) {
        place_end(tracker, way, false);
        place_end(tracker, way, true);
    }
    if (way.size() < kLeastPlaces) {
        return std::nullopt;
    }
    settle_on_whole_flanks(tracker, way);
    Seam seam;
    seam.closed = track.closed;
    double bend = 0;
    for (const TrackPoint& point : way) {
        seam.points.push_back(
            {origin + point.section.p, point.section.n1, point.section.n2, point.sigma, point.modelled});
        bend += point.bend;
    }
    // Half a radian between the flanks and nobody doubts that they are two.
    seam.confidence = std::min(1.0, bend / static_cast<double>(way.size()) / 0.5);
    return seam;
}

}  // namespace seampath::detail
