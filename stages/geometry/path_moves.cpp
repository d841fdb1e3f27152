#include "stages/geometry/path_moves.hpp"

#include <algorithm>
#include <limits>
#include <numbers>

#include "stages/geometry/pose.hpp"

namespace seampath {
namespace {

constexpr double kMinArc_rad = 5 * std::numbers::pi / 180;
constexpr double kMaxArc_rad = 175 * std::numbers::pi / 180;
constexpr double kMaxRadius_mm = 5000;
constexpr std::size_t kMaxPoses = 120;

// A straight move weighs a little less than a circular one, so that fewest moves come first.
constexpr std::size_t kLineCost = 1000;
constexpr std::size_t kArcCost = 1001;

// The curve half way between poses k and k + 1: the cubic through up to four neighbours over their chord lengths.
Eigen::Vector3d half_way(std::span<const PathPose> poses, std::size_t k) {
    const std::size_t first = k == 0 ? 0 : k - 1, last = std::min(k + 2, poses.size() - 1);
    double at[4] = {0, 0, 0, 0};
    for (std::size_t i = first + 1; i <= last; ++i) {
        at[i - first] = at[i - first - 1] + (poses[i].p - poses[i - 1].p).norm();
    }
    const double t = 0.5 * (at[k - first] + at[k + 1 - first]);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = first; i <= last; ++i) {
        double weight = 1;
        for (std::size_t j = first; j <= last; ++j) {
            const double span = at[i - first] - at[j - first];
            weight *= i == j ? 1 : span == 0 ? 0 : (t - at[j - first]) / span;
        }
        sum += weight * poses[i].p;
    }
    return sum;
}

// One move, straight or circular, between two poses.
class Candidate {
public:
    Candidate(std::span<const PathPose> poses, std::size_t from, const PathMove& move)
        : from_(poses[from]), to_(poses[move.end]) {
        if (move.via) {
            arc_ = arc_through(from_.p, poses[*move.via].p, to_.p);
        }
    }
    const std::optional<CircularArc>& arc() const { return arc_; }

    NearestOnPath nearest(const Eigen::Vector3d& p) const {
        return arc_ ? nearest_on_arc(p, *arc_) : nearest_on_segment(p, from_.p, to_.p);
    }

    MoveError error(const PathPose& pose) const {
        const NearestOnPath found = nearest(pose.p);
        return {found.distance_mm, rotation_angle(from_.q.slerp(found.fraction, to_.q), pose.q)};
    }

private:
    PathPose from_, to_;
    std::optional<CircularArc> arc_;
};

bool allowed(std::span<const PathPose> poses, std::span<const Eigen::Vector3d> middles, std::size_t from,
             const PathMove& move, const MoveTolerance& tolerance) {
    const Candidate candidate(poses, from, move);
    if (move.via) {
        const auto& arc = candidate.arc();
        if (!arc || arc->radius > kMaxRadius_mm || arc->angle < kMinArc_rad || arc->angle > kMaxArc_rad) {
            return false;
        }
    }
    for (std::size_t k = from; k < move.end; ++k) {
        if (!(candidate.nearest(middles[k]).distance_mm <= tolerance.distance_mm)) {
            return false;
        }
        const MoveError error = k > from ? candidate.error(poses[k]) : MoveError{};
        if (!(error.distance_mm <= tolerance.distance_mm && error.angle_rad <= tolerance.angle_rad)) {
            return false;
        }
    }
    return true;
}

// The pose nearest to the middle of the way, by length.
std::size_t middle_of(std::span<const double> station, std::size_t from, std::size_t to) {
    const double half = 0.5 * (station[from] + station[to]);
    const auto above = std::lower_bound(station.begin() + static_cast<std::ptrdiff_t>(from) + 1,
                                        station.begin() + static_cast<std::ptrdiff_t>(to) - 1, half);
    const auto k = static_cast<std::size_t>(above - station.begin());
    return k > from + 1 && half - station[k - 1] < station[k] - half ? k - 1 : k;
}

}  // namespace

MoveError move_error(std::span<const PathPose> poses, std::size_t from, const PathMove& move) {
    const Candidate candidate(poses, from, move);
    MoveError worst;
    for (std::size_t k = from + 1; k < move.end; ++k) {
        const MoveError error = candidate.error(poses[k]);
        worst.distance_mm = std::max(worst.distance_mm, error.distance_mm);
        worst.angle_rad = std::max(worst.angle_rad, move.via == k ? 0 : error.angle_rad);
    }
    return worst;
}

std::vector<PathMove> fewest_moves(std::span<const PathPose> poses, const MoveTolerance& tolerance) {
    const std::size_t n = poses.size();
    if (n < 2) {
        return {};
    }
    std::vector<double> station(n, 0);
    std::vector<Eigen::Vector3d> middles;
    for (std::size_t k = 0; k + 1 < n; ++k) {
        station[k + 1] = station[k] + (poses[k + 1].p - poses[k].p).norm();
        middles.push_back(half_way(poses, k));
    }
    // Shortest way through the moves that are allowed, from the first pose on.
    std::vector<std::size_t> cost(n, std::numeric_limits<std::size_t>::max()), before(n, 0);
    std::vector<PathMove> last(n);
    cost[0] = 0;
    const auto offer = [&](std::size_t from, const PathMove& move, std::size_t price) {
        if (cost[from] + price < cost[move.end]) {
            cost[move.end] = cost[from] + price;
            before[move.end] = from;
            last[move.end] = move;
        }
    };
    for (std::size_t from = 0; from + 1 < n; ++from) {
        offer(from, {from + 1, {}}, kLineCost);
        for (std::size_t to = from + 2; to < std::min(n, from + kMaxPoses + 1); ++to) {
            const PathMove line{to, {}}, arc{to, middle_of(station, from, to)};
            if (allowed(poses, middles, from, line, tolerance)) {
                offer(from, line, kLineCost);
            } else if (allowed(poses, middles, from, arc, tolerance)) {
                offer(from, arc, kArcCost);
            }
        }
    }
    std::vector<PathMove> moves;
    for (std::size_t k = n - 1; k > 0; k = before[k]) {
        moves.push_back(last[k]);
    }
    std::reverse(moves.begin(), moves.end());
    return moves;
}

}  // namespace seampath
