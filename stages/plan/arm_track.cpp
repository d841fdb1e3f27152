#include "stages/plan/arm_track.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "stages/angle.hpp"
#include "stages/geometry/pose.hpp"
#include "stages/plan/arm_postures.hpp"
#include "stages/plan/text.hpp"

namespace seampath::planning {
namespace {

// Between two poses of a chain.
constexpr double kStep_mm = 5, kStepTurn = 2 * kDegree;

// A roll of half a turn must be better than none by this much.
constexpr double kTrackRollCost = 0.05;

/// Follows one posture of the first pose at one roll.
struct Followed {
    std::vector<JointAngles> q;
    bool whole = false;
};
Followed follow(Postures& postures, std::size_t roll, const JointAngles& start) {
    Followed way{{start}, false};
    const double angle = postures.rolls()[roll];
    for (std::size_t k = 1; k < postures.chain().size(); ++k) {
        const JointAngles& before = way.q.back();
        const JointAngles* nearest = nullptr;
        double least = 1e300;
        for (const Posture& p : postures.at(k, roll)) {
            const double step = (nearest_turns(p.q, before) - before).cwiseAbs().maxCoeff();
            if (step < least) {
                least = step;
                nearest = &p.q;
            }
        }
        if (nearest == nullptr) {
            return way;
        }
        JointAngles q = nearest_turns(*nearest, before);
        if (!postures.may_step(k, before, q)) {
            const auto other = postures.next(k, angle, before);  // a singular pose leaves an axis free
            if (!other) {
                return way;
            }
            q = *other;
        }
        way.q.push_back(q);
    }
    way.whole = true;
    return way;
}

std::string angle_text(double rad) {
    return number(rad / kDegree) + " deg";
}

/// Why no posture that came so far goes on to this pose.
std::string why_not(Postures& postures, std::size_t pose) {
    bool reached = false;
    for (std::size_t roll = 0; roll < postures.rolls().size(); ++roll) {
        for (const Posture& p : postures.at(pose, roll)) {
            reached = true;
            if (!within_limits(postures.arm(), p.q).empty()) {
                return "a posture is there, but the arm would have to jump to it, or an axis to exceed its speed";
            }
        }
    }
    return reached ? "only postures outside the axes' limits reach it" : "it is out of the arm's reach";
}

std::string limit_text(const Arm& arm, int axis) {
    const ArmAxis& a = arm.axes[static_cast<std::size_t>(axis)];
    return "axis " + std::to_string(axis + 1) + " would leave its range of " + angle_text(a.lowest) + " to " +
           angle_text(a.highest);
}

std::variant<Track, Stop> track_at_one_roll(Postures& postures) {
    Track best;
    Stop stop{0, ""};
    double best_worth = -1;
    const std::size_t size = postures.chain().size();
    for (std::size_t roll = 0; roll < postures.rolls().size(); ++roll) {
        const std::vector<Posture> starts = postures.at(0, roll);
        for (const Posture& start : starts) {
            const Followed way = follow(postures, roll, start.q);
            Lifted lifted = lift(postures.arm(), way.q);
            if (lifted.stop >= stop.pose && lifted.stop < size) {
                const bool limits = lifted.stop < way.q.size();
                stop = {lifted.stop, limits ? limit_text(postures.arm(), lifted.axis) : ""};
            }
            if (lifted.stop < size) {
                continue;
            }
            const double score = score_of(postures, lifted.q);
            const double worth = score - kTrackRollCost * std::abs(postures.rolls()[roll]) / std::numbers::pi;
            if (worth > best_worth) {
                best_worth = worth;
                best = {std::move(lifted.q), std::vector<double>(size, postures.rolls()[roll]), score};
            }
            if (postures.options().any) {
                return best;
            }
        }
    }
    if (!best.q.empty()) {
        return best;
    }
    if (stop.why.empty()) {
        stop.why = why_not(postures, stop.pose);
    }
    return stop;
}

}  // namespace

bool Track::constant_roll() const {
    return std::all_of(roll.begin(), roll.end(), [this](double r) { return r == roll.front(); });
}

Chain chain_of(const std::vector<Waypoint>& waypoints, std::size_t first, std::size_t last, const ArmCell& cell) {
    Chain chain;
    const auto add = [&](const Waypoint& w, int index) {
        Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
        pose.linear() = w.q.toRotationMatrix();
        pose.translation() = w.p;
        chain.push_back({cell.base_from_scan * pose, w, index});
    };
    add(waypoints[first], static_cast<int>(first));
    for (std::size_t k = first + 1; k <= last; ++k) {
        const Waypoint &from = waypoints[k - 1], &to = waypoints[k];
        const double pieces =
            std::ceil(std::max({1.0, (to.p - from.p).norm() / kStep_mm, rotation_angle(from.q, to.q) / kStepTurn}));
        for (double piece = 1; piece < pieces; ++piece) {
            const double share = piece / pieces;
            Waypoint between = to;
            if (between.kind == WaypointKind::weld_end) {
                between.kind = WaypointKind::weld;
            }
            between.p = from.p + share * (to.p - from.p);
            between.q = from.q.slerp(share, to.q);
            between.station_mm = from.station_mm + share * (to.station_mm - from.station_mm);
            between.time_s = from.time_s + share * (to.time_s - from.time_s);
            between.sigma_mm = from.sigma_mm + share * (to.sigma_mm - from.sigma_mm);
            add(between, -1);
        }
        add(to, static_cast<int>(k));
    }
    return chain;
}

std::variant<Track, Stop> track(const Chain& chain, const ArmCell& cell, const TrackOptions& options) {
    Postures postures(chain, cell, options);
    auto fixed = track_at_one_roll(postures);
    if (std::holds_alternative<Track>(fixed) || !options.roll_may_change || options.max_roll < options.roll_step) {
        return fixed;
    }
    auto changing = track_with_changes(postures);
    if (auto* stop = std::get_if<Stop>(&changing); stop != nullptr && stop->why.empty()) {
        stop->why = why_not(postures, stop->pose);
    }
    return changing;
}

}  // namespace seampath::planning
