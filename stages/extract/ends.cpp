#include "stages/extract/ends.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "stages/geometry/robust.hpp"

namespace seampath::detail {
namespace {

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
    const auto fit = fit_section(tracker.grid, scale, place.section, tracker.windows_at(place.section));
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
}  // namespace

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

bool unsure(const Tracker& tracker, const TrackPoint& point) {
    return point.sigma > 2 * noise_of(tracker.scale_at(point.section));
}

std::optional<TrackPoint> measure_near_end(const Tracker& tracker, const Section& guess, double to_end) {
    constexpr int kRounds = 3;
    constexpr double kSurer = 0.7;  // of the other's sigma: as if it had seen twice as much
    Tracker longer = tracker;
    longer.reach_further = std::max(0.0, tracker.window_at(guess).along - to_end);
    auto point = longer.measure(guess, kRounds);
    if (point && !unsure(tracker, *point) && longer.reach_further > 0) {
        auto usual = tracker.measure(guess, kRounds);
        if (usual && usual->sigma < kSurer * point->sigma) {
            return usual;
        }
    }
    return point;
}

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
    auto end = measure_near_end(tracker, guess, straight ? 0 : along);
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

}  // namespace seampath::detail
