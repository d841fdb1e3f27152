#include "stages/plan/stations.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "stages/angle.hpp"
#include "stages/error.hpp"
#include "stages/plan/text.hpp"

namespace seampath::planning {
namespace {

// A move shorter than this is no progress: the torch direction jumps.
constexpr double kMinStep_mm = 1e-6;

// A change of speed so near to a waypoint is told by that one.
constexpr double kMinChange_mm = 0.01;

constexpr double kMostWaypoints = 1e6;

// Halvings of the share of the limits that every move uses; found to one in a million, waypoints are the same from
// either end to 0.1 um on the seams of the tests.
constexpr int kEveningBisections = 20;

struct Limits {
    double chord_mm;
    double turn;  // rad
};

// Up to 1: the move holds its limits.
double use(const Chord& c, const Limits& limits) {
    return std::max(c.error_mm / limits.chord_mm, c.turn / limits.turn);
}

// One greedy pass from an end of the seam towards the other.
class Greedy {
public:
    Greedy(const TorchPath& path, const Samples& samples, const Limits& limits, bool forward)
        : path_(path), samples_(samples), limits_(limits), forward_(forward) {}

    /// Stations from end to end, ascending. Where the torch direction jumps by more than the limit they stop short of
    /// it.
    std::vector<double> stations() const {
        const TorchPose* from = &sample(0);
        TorchPose reached;
        std::vector<double> result{from->station_mm};
        const double end = sample(count() - 1).u;
        while (from->u != end) {
            const TorchPose next = reach(*from);
            if (std::abs(next.station_mm - from->station_mm) < kMinStep_mm && next.u != end) {
                break;
            }
            reached = next;
            from = &reached;
            result.push_back(from->station_mm);
        }
        if (!forward_) {
            std::reverse(result.begin(), result.end());
        }
        return result;
    }

private:
    std::ptrdiff_t count() const { return std::ssize(samples_.pose); }
    const TorchPose& sample(std::ptrdiff_t i) const { return samples_.pose[forward_ ? i : count() - 1 - i]; }
    double use_of(const TorchPose& a, const TorchPose& b) const {
        return use(forward_ ? chord(samples_, a, b) : chord(samples_, b, a), limits_);
    }

    // Index of the first sample beyond a.
    std::ptrdiff_t beyond(const TorchPose& a) const {
        const auto& pose = samples_.pose;
        const auto before = [](const TorchPose& s, double u) { return s.u < u; };
        const auto upto = [](double u, const TorchPose& s) { return u < s.u; };
        return forward_ ? std::upper_bound(pose.begin(), pose.end(), a.u, upto) - pose.begin()
                        : pose.end() - std::lower_bound(pose.begin(), pose.end(), a.u, before);
    }

    // Furthest pose that one move from a may go to: samples in growing strides, then bisected, then between two
    // samples.
    TorchPose reach(const TorchPose& a) const {
        const std::ptrdiff_t first = beyond(a);
        std::ptrdiff_t good = first - 1, bad = first;
        for (std::ptrdiff_t stride = 1; use_of(a, sample(bad)) <= 1; stride *= 2) {
            good = bad;
            if (good == count() - 1) {
                return sample(good);
            }
            bad = std::min(count() - 1, bad + stride);
        }
        while (bad - good > 1) {
            const std::ptrdiff_t middle = good + (bad - good) / 2;
            (use_of(a, sample(middle)) <= 1 ? good : bad) = middle;
        }
        return between(a, good < first ? a : sample(good), sample(bad));
    }

    // Where use() reaches 1 between a pose that holds and one that does not: false position, Illinois rule
    // (Dowell & Jarratt, BIT 11, 1971); returns a pose that holds.
    TorchPose between(const TorchPose& a, TorchPose good, const TorchPose& bad) const {
        double low = good.u, high = bad.u, at_low = use_of(a, good) - 1, at_high = use_of(a, bad) - 1;
        double slack = at_low;
        bool last_held = false, last_failed = false;
        for (int iteration = 0; iteration < 60 && slack < -1e-10; ++iteration) {
            const double u = (low * at_high - high * at_low) / (at_high - at_low);
            if (u == low || u == high) {
                break;
            }
            const TorchPose pose = path_.at_parameter(u);
            const double excess = use_of(a, pose) - 1;
            const bool held = excess <= 0;
            (held ? low : high) = u;
            (held ? at_low : at_high) = excess;
            if (held ? last_held : last_failed) {
                (held ? at_high : at_low) *= 0.5;
            }
            last_held = held;
            last_failed = !held;
            if (held) {
                good = pose;
                slack = excess;
            }
        }
        return good;
    }

    const TorchPath& path_;
    const Samples& samples_;
    Limits limits_;
    bool forward_;
};

std::vector<TorchPose> poses_at(const TorchPath& path, const std::vector<double>& stations) {
    std::vector<TorchPose> poses;
    for (const double station : stations) {
        poses.push_back(path.at_station(station));
    }
    return poses;
}

bool holds(const Samples& samples, const std::vector<TorchPose>& poses, const Limits& limits) {
    for (std::size_t k = 0; k + 1 < poses.size(); ++k) {
        if (use(chord(samples, poses[k], poses[k + 1]), limits) > 1) {
            return false;
        }
    }
    return true;
}

std::vector<double> equal_steps(double from, double to, std::size_t moves) {
    std::vector<double> stations;
    for (std::size_t k = 0; k <= moves; ++k) {
        const double way = (to - from) * static_cast<double>(k) / static_cast<double>(moves);
        stations.push_back(k == moves ? to : from + way);
    }
    return stations;
}

struct Passes {
    std::vector<double> forward, backward;

    std::size_t moves() const { return std::min(forward.size(), backward.size()) - 1; }
};

Passes greedy(const TorchPath& path, const Samples& samples, const Limits& limits) {
    return {Greedy(path, samples, limits, true).stations(), Greedy(path, samples, limits, false).stations()};
}

// What is left of the slack, spread over all moves; the shorter pass as it is where they differ in length.
std::vector<double> spread(const Passes& passes) {
    const auto& [f, b] = passes;
    if (f.size() != b.size()) {
        return f.size() < b.size() ? f : b;
    }
    std::vector<double> stations;
    const double moves = static_cast<double>(f.size()) - 1;
    for (std::size_t k = 0; k < f.size(); ++k) {
        stations.push_back(f[k] - (f[k] - b[k]) * static_cast<double>(k) / moves);
    }
    return stations;
}

// Of the seam, or of what lies between two of its corners.
std::vector<TorchPose> choose(const TorchPath& path, const Samples& samples, const Limits& limits) {
    const double first = samples.pose.front().station_mm, last = samples.pose.back().station_mm;
    Passes passes = greedy(path, samples, limits);
    if (passes.forward.back() < last || passes.backward.front() > first) {
        const double jump = passes.forward.back() < last ? passes.forward.back() : passes.backward.front();
        throw InputError(seam_text(path.seam()) + ": the torch direction jumps at station " + number(jump) +
                         " mm, so no move holds plan.max_turn_deg = " + number(limits.turn / kDegree) +
                         "; a smooth curve and smooth flanks are needed; look at the seam there");
    }
    const std::size_t moves = passes.moves();
    std::vector<TorchPose> poses = poses_at(path, equal_steps(first, last, moves));
    if (holds(samples, poses, limits)) {
        return poses;
    }
    // Smallest share of the limits that needs no more moves: there all moves are about as good, and little slack is
    // left.
    double few = 1, many = 0;
    for (int bisection = 0; bisection < kEveningBisections; ++bisection) {
        const double share = 0.5 * (few + many);
        Passes tighter = greedy(path, samples, {share * limits.chord_mm, share * limits.turn});
        const bool enough = tighter.forward.size() <= moves + 1 && tighter.backward.size() <= moves + 1 &&
                            tighter.forward.back() == last && tighter.backward.front() == first;
        (enough ? few : many) = share;
        if (enough) {
            passes = std::move(tighter);
        }
    }
    poses = poses_at(path, spread(passes));
    return holds(samples, poses, limits)
               ? poses
               : poses_at(path, passes.forward.size() - 1 == moves ? passes.forward : passes.backward);
}

// At equal times, equal distances or knots.
std::vector<double> asked_stations(const TorchPath& path, const SpeedProfile& profile, const PlanOptions& options) {
    const double end = path.arc().length();
    std::vector<double> stations{0};
    // Near to rest even a short step takes its time.
    const double least = options.period_s ? 0 : kMinStep_mm;
    const auto add = [&](double station) {
        if (station > stations.back() + least && station < end - least) {
            stations.push_back(station);
        }
    };
    if (options.at_knots) {
        for (const double knot : path.arc().curve().knots) {
            add(path.arc().station(std::clamp(knot, path.first(), path.last())));
        }
    } else {
        const double every = options.period_s ? *options.period_s : *options.step_mm;
        const double all = options.period_s ? profile.duration() : end;
        if (all / every > kMostWaypoints) {
            throw InputError(seam_text(path.seam()) + ": plan." + (options.period_s ? "period_s = " : "step_mm = ") +
                             number(every) + " gives " + number(std::ceil(all / every)) + " waypoints; at most " +
                             number(kMostWaypoints) + " are made of a weld; a larger one is needed");
        }
        for (int k = 1; k * every < all; ++k) {
            add(options.period_s ? profile.station(k * every) : k * every);
        }
    }
    stations.push_back(end);
    for (const double corner : path.corners()) {
        const auto above = std::lower_bound(stations.begin(), stations.end(), corner);
        if (!options.period_s && std::min(*above - corner, corner - *(above - 1)) > kMinStep_mm) {
            stations.insert(above, corner);
        }
    }
    return stations;
}

// What lies between corners, both ends included.
std::vector<Samples> between_corners(const TorchPath& path, const Samples& samples) {
    std::vector<Samples> parts(1);
    const std::vector<double> corners = path.corners();
    for (std::size_t i = 0; i < samples.pose.size(); ++i) {
        const TorchPose& pose = samples.pose[i];
        parts.back().pose.push_back(pose);
        if (std::any_of(corners.begin(), corners.end(),
                        [&](double corner) { return std::abs(corner - pose.station_mm) < kMinStep_mm; })) {
            parts.emplace_back().pose.push_back(pose);
        }
        if (i < samples.bulge_mm.size()) {
            parts.back().bulge_mm.push_back(samples.bulge_mm[i]);
        }
    }
    return parts;
}

// And where the speed changes.
std::vector<TorchPose> with_changes(const TorchPath& path, const SpeedProfile& profile, std::vector<TorchPose> poses) {
    for (const double station : profile.changes()) {
        const auto above = std::lower_bound(poses.begin(), poses.end(), station,
                                            [](const TorchPose& pose, double s) { return pose.station_mm < s; });
        if (above != poses.begin() && above != poses.end() &&
            std::min(above->station_mm - station, station - (above - 1)->station_mm) > kMinChange_mm) {
            poses.insert(above, path.at_station(station));
        }
    }
    return poses;
}

}  // namespace

WeldPoses weld_poses(const TorchPath& path, const Samples& samples, const SpeedProfile& profile,
                     const PlanOptions& options) {
    WeldPoses result;
    if (options.period_s || options.step_mm || options.at_knots) {
        result.poses = poses_at(path, asked_stations(path, profile, options));
    } else {
        const Limits limits{options.chord_tolerance_mm, options.max_turn_deg * kDegree};
        for (const Samples& part : between_corners(path, samples)) {
            const std::vector<TorchPose> poses = choose(path, part, limits);
            result.poses.insert(result.poses.end(), poses.begin() + (result.poses.empty() ? 0 : 1), poses.end());
        }
        result.poses = with_changes(path, profile, std::move(result.poses));
    }
    for (std::size_t k = 0; k + 1 < result.poses.size(); ++k) {
        result.max_chord_error_mm =
            std::max(result.max_chord_error_mm, chord(samples, result.poses[k], result.poses[k + 1]).error_mm);
    }
    return result;
}

}  // namespace seampath::planning
