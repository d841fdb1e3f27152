#include "stages/extract/join.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace seampath::detail {
namespace {

constexpr double kMostWindows = 6;                              // longest gap, in widths of the window
constexpr double kMostShare = 0.35;                             // of the length of what is joined
constexpr double kMostAngle = 50 * std::numbers::pi / 180;      // between the ends' directions and the chord
constexpr double kMostAsymmetry = 12 * std::numbers::pi / 180;  // between the two: an arc leaves as it arrives
constexpr double kMostGapTwist = 60 * std::numbers::pi / 180;   // of a flank normal across the gap

double length_of(const Track& track) {
    double length = 0;
    for (std::size_t i = 1; i < track.points.size(); ++i) {
        length += (track.points[i].section.p - track.points[i - 1].section.p).norm();
    }
    return length;
}

double angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b));
}

// A representative of an end: the last few points of a track have data on one side only.
const TrackPoint& firm_end(const Track& track, bool front) {
    const std::size_t inside = std::min<std::size_t>(2, track.points.size() - 1);
    return front ? track.points[inside] : track.points[track.points.size() - 1 - inside];
}

// Cubic from a to b with the measured directions at both.
TrackPoint between(const TrackPoint& a, const TrackPoint& b, double x) {
    const double length = (b.section.p - a.section.p).norm() * (1 + angle(a.t, b.t) * angle(a.t, b.t) / 24);
    const double h00 = (1 + 2 * x) * (1 - x) * (1 - x), h10 = x * (1 - x) * (1 - x), h01 = x * x * (3 - 2 * x),
                 h11 = x * x * (x - 1);
    TrackPoint p = a;
    p.section.p = h00 * a.section.p + h01 * b.section.p + length * (h10 * a.t + h11 * b.t);
    p.section.n1 = ((1 - x) * a.section.n1 + x * b.section.n1).normalized();
    p.section.n2 = ((1 - x) * a.section.n2 + x * b.section.n2).normalized();
    p.t = p.section.n1.cross(p.section.n2).normalized();
    p.bend = (1 - x) * a.bend + x * b.bend;
    p.sigma = std::max(a.sigma, b.sigma) * (1 + 4 * x * (1 - x) * length / (a.along + b.along));
    p.modelled = true;
    return p;
}

// Whether, at this bridged place, a flank is seen to go on beyond the line where the other should stand.
bool flank_goes_through(const Tracker& tracker, const TrackPoint& place, double density) {
    const Section& at = place.section;
    const Eigen::Vector3d d[2] = {place.t.cross(at.n1), at.n2.cross(place.t)}, n[2] = {at.n1, at.n2};
    const ScanScale scale = tracker.scale_at(at);
    const SectionWindow window = tracker.window_of(scale);
    const double band = 2 * window.band, far = 0.5 * window.away, slab = tracker.step;
    for (int k = 0; k < 2; ++k) {
        double beyond = 0;
        tracker.grid.for_points_in_ball(at.p, std::hypot(far, slab), [&](const Eigen::Vector3f& q, double) {
            const Eigen::Vector3d v = q.cast<double>() - at.p;
            const double u = v.dot(d[k]), z = std::abs(v.dot(n[k]));
            beyond +=
                u < -band && u > -far && std::abs(v.dot(place.t)) < slab && z < 4 * scale.noise + 0.1 * std::abs(u);
        });
        if (beyond > 0.3 * density * 2 * slab * (far - band)) {
            return true;
        }
    }
    return false;
}

// Whether something stands across the joint between two ends, a rib or another wall: points in the open between the
// flanks.
bool wall_between(const Tracker& tracker, const TrackPoint& a, const TrackPoint& b, double density) {
    constexpr double kLeastShare = 0.2;  // of a wall that fills the corner
    const Eigen::Vector3d middle = 0.5 * (a.section.p + b.section.p), chord = b.section.p - a.section.p;
    const Eigen::Vector3d t = chord.normalized(), n1 = (a.section.n1 + b.section.n1).normalized(),
                          n2 = (a.section.n2 + b.section.n2).normalized();
    const SectionWindow window = tracker.window_of(tracker.scale_at(a.section));
    const double near = 2 * window.band, far = 0.7 * window.away, half = 0.5 * chord.norm() + 2 * tracker.step;
    double between = 0;
    tracker.grid.for_points_in_ball(middle, std::hypot(1.5 * far, half), [&](const Eigen::Vector3f& q, double) {
        const Eigen::Vector3d v = q.cast<double>() - middle;
        const double z1 = v.dot(n1), z2 = v.dot(n2);
        between += std::min(z1, z2) > near && std::max(z1, z2) < far && std::abs(v.dot(t)) < half;
    });
    return between > kLeastShare * density * (far - near) * (far - near);
}

struct Bridge {
    double cost = 0;
    std::size_t from = 0, to = 0;             // the end of track `from` meets the beginning of track `to`,
    bool turn_from = false, turn_to = false;  // each perhaps turned round first
    std::vector<TrackPoint> points;
};

std::optional<Bridge> bridge(const Tracker& tracker, const Track& from, const Track& to, bool same) {
    const TrackPoint &a = firm_end(from, false), &b = firm_end(to, true);
    const Eigen::Vector3d chord = b.section.p - a.section.p;
    const double gap = chord.norm();
    const double supported = length_of(from) + (same ? 0 : length_of(to));
    const double leave = angle(a.t, chord), arrive = angle(chord, b.t);
    if (gap > kMostWindows * tracker.window_at(a.section).away || gap > kMostShare * supported ||
        std::max(leave, arrive) > kMostAngle ||
        std::abs(leave - arrive) > kMostAsymmetry + 4 * tracker.step / (gap + tracker.step) * 0.1 ||
        angle(a.section.n1, b.section.n1) > kMostGapTwist || angle(a.section.n2, b.section.n2) > kMostGapTwist) {
        return std::nullopt;
    }
    Bridge result;
    result.cost = gap * (1 + leave + arrive);
    const double spacing = tracker.scale_at(a.section).spacing, density = 1 / (spacing * spacing);
    if (wall_between(tracker, a, b, density)) {
        return std::nullopt;
    }
    const int count = static_cast<int>(std::lround(gap / tracker.step));
    int through = 0;
    for (int i = 1; i < count; ++i) {
        result.points.push_back(between(a, b, static_cast<double>(i) / count));
        through += flank_goes_through(tracker, result.points.back(), density);
    }
    return 3 * through > count ? std::nullopt : std::optional(result);
}

// The same joint, travelled the other way.
void turn_round(Track& track) {
    std::reverse(track.points.begin(), track.points.end());
    for (TrackPoint& p : track.points) {
        std::swap(p.section.n1, p.section.n2);
        std::swap(p.support[0], p.support[1]);
        p.t = -p.t;
    }
}

void splice(std::vector<Track>& tracks, const Bridge& best) {
    if (best.turn_from) {
        turn_round(tracks[best.from]);
    }
    if (best.turn_to) {
        turn_round(tracks[best.to]);
    }
    const auto firm = [](std::vector<TrackPoint>& points, bool front) {
        const auto inside = static_cast<std::ptrdiff_t>(std::min<std::size_t>(2, points.size() - 1));
        front ? points.erase(points.begin(), points.begin() + inside)
              : points.erase(points.end() - inside, points.end());
    };
    std::vector<TrackPoint>& way = tracks[best.from].points;
    firm(way, false);
    if (best.from == best.to) {
        firm(way, true);
        way.insert(way.end(), best.points.begin(), best.points.end());
        tracks[best.from].closed = true;
        return;
    }
    std::vector<TrackPoint>& rest = tracks[best.to].points;
    firm(rest, true);
    way.insert(way.end(), best.points.begin(), best.points.end());
    way.insert(way.end(), rest.begin(), rest.end());
    tracks.erase(tracks.begin() + static_cast<std::ptrdiff_t>(best.to));
}

}  // namespace

std::vector<Track> join_tracks(const Tracker& tracker, std::vector<Track> tracks) {
    while (true) {
        std::optional<Bridge> best;
        const auto consider = [&](std::size_t i, std::size_t j, bool turn_i, bool turn_j, const Track& from,
                                  const Track& to) {
            auto candidate = bridge(tracker, from, to, i == j);
            if (candidate && (!best || candidate->cost < best->cost)) {
                candidate->from = i, candidate->to = j, candidate->turn_from = turn_i, candidate->turn_to = turn_j;
                best = candidate;
            }
        };
        for (std::size_t i = 0; i < tracks.size(); ++i) {
            for (std::size_t j = i; j < tracks.size(); ++j) {
                const Track &a = tracks[i], &b = tracks[j];
                if (a.closed || b.closed || a.points.size() < 6 || b.points.size() < 6) {
                    continue;
                }
                consider(i, j, false, false, a, b);
                if (i != j) {
                    // The same joint found from its other side runs the other way.
                    Track turned_a = a, turned_b = b;
                    turn_round(turned_a);
                    turn_round(turned_b);
                    consider(i, j, false, true, a, turned_b);
                    consider(i, j, true, false, turned_a, b);
                    consider(i, j, true, true, turned_a, turned_b);
                }
            }
        }
        if (!best) {
            return tracks;
        }
        splice(tracks, *best);
    }
}

}  // namespace seampath::detail
