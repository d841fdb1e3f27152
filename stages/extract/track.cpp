#include "stages/extract/track.hpp"

#include <algorithm>
#include <cmath>

#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/geometry/robust.hpp"

namespace seampath::detail {
namespace {

constexpr double kLeastBend = 5 * kDegree;  // flatter than this two flanks are one surface to a welder
constexpr double kMostTurn = 35 * kDegree;  // of a flank normal against its prediction, per step
constexpr double kLeastSupport = 0.1;       // of the density that the flank had so far: four views may become one
constexpr double kCorner = 45 * kDegree;    // of a flank normal over the next number of steps
constexpr std::size_t kCornerSteps = 3;
constexpr std::size_t kMostSteps = 200000;

bool similar(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double angle) {
    return a.dot(b) > std::cos(angle);
}

bool supported(const std::vector<TrackPoint>& way, const TrackPoint& point) {
    for (int k = 0; k < 2; ++k) {
        std::vector<double> before;
        for (std::size_t i = way.size() > 15 ? way.size() - 15 : 0; i < way.size(); ++i) {
            if (!way[i].modelled) {
                before.push_back(way[i].support[k]);
            }
        }
        if (point.support[k] < kLeastSupport * quantile(before, 0.5)) {
            return false;
        }
    }
    return true;
}

bool believable(const Tracker& tracker, const Section& predicted, const TrackPoint& point) {
    const double reach = 0.7 * tracker.step + 3 * tracker.scale_at(predicted).noise + 4 * point.sigma;
    return point.bend >= kLeastBend && (point.section.p - predicted.p).norm() <= reach &&
           similar(point.section.n1, predicted.n1, kMostTurn) && similar(point.section.n2, predicted.n2, kMostTurn);
}

// Near, and with the same two flanks in either order.
bool same_place(const TrackPoint& q, const Section& place, double reach) {
    return (q.section.p - place.p).squaredNorm() < reach * reach &&
           ((similar(q.section.n1, place.n1, kMostTurn) && similar(q.section.n2, place.n2, kMostTurn)) ||
            (similar(q.section.n1, place.n2, kMostTurn) && similar(q.section.n2, place.n1, kMostTurn)));
}

bool met(const std::vector<Track>& taken, const Section& place, double reach) {
    return std::any_of(taken.begin(), taken.end(), [&](const Track& track) { return lies_on(track, place, reach); });
}

// The scan's points on flank k of a fitted section, up to `half` mm to each side of it.
std::vector<SlabPoint> slab_of(const Tracker& tracker, const SectionFit& at, int k, double half) {
    const Flank& flank = at.flank[k];
    const SectionFrame& f = at.frame;
    const SectionWindow& w = flank.window;
    Eigen::Vector3d low = f.p, high = f.p;
    for (const double u : {w.band, w.away}) {
        for (const double s : {-half, half}) {
            for (const double side : {-1.0, 1.0}) {
                const double z = side * gate(flank, u, s) - residual(flank, u, s, 0);
                const Eigen::Vector3d corner = f.p + u * f.d[k] + s * f.t + z * f.n[k];
                low = low.cwiseMin(corner);
                high = high.cwiseMax(corner);
            }
        }
    }
    std::vector<SlabPoint> slab;
    tracker.grid.for_cells_in_box(low, high, [&](std::size_t cell) {
        const auto points = tracker.grid.points(cell);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Eigen::Vector3d v = points[i].cast<double>() - f.p;
            const double u = v.dot(f.d[k]), s = v.dot(f.t);
            if (std::abs(s) > half || u < w.band || u > w.away) {
                continue;
            }
            const double off = residual(flank, u, s, v.dot(f.n[k]));
            if (std::abs(off) <= gate(flank, u, s)) {
                const auto& starts = tracker.view_starts;
                const auto source = tracker.grid.source(tracker.grid.first_point(cell) + i);
                const auto view = std::upper_bound(starts.begin(), starts.end(), source) - starts.begin();
                slab.push_back(
                    {points[i], static_cast<float>(u), static_cast<float>(off), static_cast<std::uint32_t>(view)});
            }
        }
    });
    return slab;
}

// Whether the way has just turned from one flank onto another: faster than on the smallest bend that windows can
// follow.
bool turns_corner(const std::vector<TrackPoint>& way) {
    if (way.size() <= kCornerSteps) {
        return false;
    }
    const Section &now = way.back().section, &before = way[way.size() - 1 - kCornerSteps].section;
    return !similar(now.n1, before.n1, kCorner) || !similar(now.n2, before.n2, kCorner);
}

enum class End { open, closed };

// Extends `way` in one direction (+1: along n1 x n2) as far as the joint is measured. Coming back to its own course it
// is closed; what then lies before the place where it came back is a piece travelled twice.
End advance(const Tracker& tracker, std::vector<TrackPoint>& way, double direction, const std::vector<Track>& taken) {
    constexpr std::size_t kBehind = 10;  // the latest points are near in any case
    while (way.size() < kMostSteps) {
        const double step = std::min(tracker.step, std::max(0.25 * tracker.step, 0.7 * way.back().along));
        const Section predicted = carry_on(way, direction, step);
        const auto point = tracker.measure(predicted, 2);
        if (!point || !believable(tracker, predicted, *point) || !supported(way, *point) ||
            met(taken, point->section, 0.7 * step)) {
            return End::open;
        }
        for (std::size_t i = 0; i + kBehind < way.size(); ++i) {
            if (same_place(way[i], point->section, 0.7 * step)) {
                way.erase(way.begin(), way.begin() + static_cast<std::ptrdiff_t>(i));
                return End::closed;
            }
        }
        way.push_back(*point);
        if (turns_corner(way)) {
            way.resize(way.size() - kCornerSteps);
            return End::open;
        }
    }
    return End::open;
}

}  // namespace

std::optional<TrackPoint> Tracker::measure(const Section& guess, int rounds) const {
    const auto fit = settle_section(grid, scale_at(guess), guess, windows_at(guess), rounds);
    if (!fit) {
        return std::nullopt;
    }
    TrackPoint point;
    point.section = fit->section;
    point.t = fit->t;
    point.sigma = fit->sigma;
    point.bend = fit->bend;
    point.along = std::min(fit->flank[0].window.along, fit->flank[1].window.along);
    point.away = wall ? fit->flank[0].window.away : std::min(fit->flank[0].window.away, fit->flank[1].window.away);
    point.rough =
        std::max(fit->flank[0].fit.scale() / fit->flank[0].noise, fit->flank[1].fit.scale() / fit->flank[1].noise);
    for (int k = 0; k < 2; ++k) {
        point.support[k] = fit->flank[k].slab_points;
        point.flank_scale[k] = fit->flank[k].fit.scale();
        point.flank_sigma[k] = fit->flank[k].sigma;
        point.slab[k] = slab_of(*this, *fit, k, 0.5 * step);
    }
    return point;
}

Section carry_on(const std::vector<TrackPoint>& way, double direction, double step) {
    const TrackPoint& last = way.back();
    Section next = last.section;
    Eigen::Vector3d t = direction * last.t;
    if (way.size() > 4) {
        // Over four points: one point's noise must not steer.
        const TrackPoint& before = way[way.size() - 5];
        const double distance = (last.section.p - before.section.p).norm();
        const double ratio = distance > 0 ? step / distance : 0;
        t += 0.5 * ratio * direction * (last.t - before.t);
        next.n1 = (last.section.n1 + ratio * (last.section.n1 - before.section.n1)).normalized();
        next.n2 = (last.section.n2 + ratio * (last.section.n2 - before.section.n2)).normalized();
    }
    next.p += step * t.normalized();
    return next;
}

bool lies_on(const Track& track, const Section& place, double reach) {
    return std::any_of(track.points.begin(), track.points.end(),
                       [&](const TrackPoint& q) { return same_place(q, place, reach); });
}

std::optional<Track> follow(const Tracker& tracker, const Crease& seed, const std::vector<Track>& taken) {
    const auto first = tracker.measure({seed.p, seed.n1, seed.n2}, 6);
    if (!first || first->bend < kLeastBend || (first->section.p - seed.p).norm() > 2 * tracker.step ||
        !similar(first->section.n1, seed.n1, kMostTurn) || !similar(first->section.n2, seed.n2, kMostTurn) ||
        met(taken, first->section, tracker.step)) {
        return std::nullopt;
    }
    Track track;
    track.points = {*first};
    if (advance(tracker, track.points, 1, taken) == End::closed) {
        track.closed = true;
        return track;
    }
    std::reverse(track.points.begin(), track.points.end());
    track.closed = advance(tracker, track.points, -1, taken) == End::closed;
    std::reverse(track.points.begin(), track.points.end());
    return track;
}

}  // namespace seampath::detail
