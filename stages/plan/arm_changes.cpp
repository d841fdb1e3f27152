#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "stages/plan/arm_postures.hpp"

namespace seampath::planning {
namespace {

// Costs of a pose: of being bad, of an axis's way, rad^2, and of a step of the roll.
constexpr double kBadCost = 10, kWayCost = 1, kRollCost = 0.02;

constexpr int kSmoothings = 200;

// Turns of the same posture closer than this are the same.
constexpr double kSame = 1e-3;

/// A place of a way: which roll, which posture with its turns, how cheap it is to get there, and from where.
struct State {
    std::size_t roll, posture;
    JointAngles q;
    double cost;
    std::size_t from;
};
using States = std::vector<State>;

double pose_cost(const Arm& arm, const JointAngles& q, double dexterity) {
    const double bad = 1 - goodness(limit_margin(arm, q), dexterity);
    return kBadCost * bad * bad;
}

// Before and after the weld the torch keeps its roll.
bool may_turn(const Chain& chain, std::size_t pose) {
    const WaypointKind kind = chain[pose].at.kind;
    return kind == WaypointKind::weld || kind == WaypointKind::weld_end;
}

/// The states of one pose: of those that are the same the cheapest.
class Gathering {
public:
    explicit Gathering(std::size_t rolls) : at_(rolls * 8) {}

    void add(const State& state) {
        auto& same = at_[state.roll * 8 + state.posture];
        for (const std::size_t k : same) {
            if ((states_[k].q - state.q).cwiseAbs().maxCoeff() < kSame) {
                if (state.cost < states_[k].cost) {
                    states_[k] = state;
                }
                return;
            }
        }
        same.push_back(states_.size());
        states_.push_back(state);
    }
    States take() { return std::move(states_); }

private:
    States states_;
    std::vector<std::vector<std::size_t>> at_;
};

States first_states(Postures& postures) {
    States states;
    for (std::size_t roll = 0; roll < postures.rolls().size(); ++roll) {
        const auto& all = postures.at(0, roll);
        for (std::size_t p = 0; p < all.size(); ++p) {
            for (const JointAngles& q : within_limits(postures.arm(), all[p].q)) {
                states.push_back({roll, p, q, pose_cost(postures.arm(), q, all[p].dexterity), 0});
            }
        }
    }
    return states;
}

States next_states(Postures& postures, std::size_t pose, const States& before) {
    Gathering gathering(postures.rolls().size());
    for (std::size_t s = 0; s < before.size(); ++s) {
        const State& from = before[s];
        const std::size_t change = may_turn(postures.chain(), pose) ? 1 : 0;
        const std::size_t first = from.roll - std::min(from.roll, change);
        const std::size_t last = std::min(from.roll + change, postures.rolls().size() - 1);
        for (std::size_t roll = first; roll <= last; ++roll) {
            const auto& all = postures.at(pose, roll);
            for (std::size_t p = 0; p < all.size(); ++p) {
                const JointAngles q = nearest_turns(all[p].q, from.q);
                if (limit_margin(postures.arm(), q) < 0 || !postures.may_step(pose, from.q, q)) {
                    continue;
                }
                const double way = kWayCost * (q - from.q).squaredNorm() + (roll == from.roll ? 0 : kRollCost);
                gathering.add({roll, p, q, from.cost + way + pose_cost(postures.arm(), q, all[p].dexterity), s});
            }
        }
    }
    return gathering.take();
}

/// The same posture along other rolls; empty when it does not get through.
std::vector<JointAngles> along(const Postures& postures, const std::vector<double>& roll, const JointAngles& start) {
    std::vector<JointAngles> q;
    JointAngles before = start;
    for (std::size_t k = 0; k < roll.size(); ++k) {
        const auto next = postures.next(k, roll[k], before);
        if (!next || limit_margin(postures.arm(), *next) < 0) {
            return {};
        }
        q.push_back(*next);
        before = *next;
    }
    return q;
}

void smooth(const Postures& postures, Track& way) {
    std::vector<double> roll = way.roll;
    for (int round = 0; round < kSmoothings; ++round) {
        std::vector<double> smoother = roll;
        for (std::size_t k = 1; k + 1 < roll.size(); ++k) {
            if (postures.chain()[k].at.kind != WaypointKind::weld) {
                continue;
            }
            smoother[k] = 0.25 * roll[k - 1] + 0.5 * roll[k] + 0.25 * roll[k + 1];
        }
        const std::vector<JointAngles> q = along(postures, smoother, way.q.front());
        if (q.empty()) {
            return;
        }
        roll = smoother;
        way.roll = smoother;
        way.q = q;
    }
}

}  // namespace

std::variant<Track, Stop> track_with_changes(Postures& postures) {
    const std::size_t size = postures.chain().size();
    std::vector<States> states{first_states(postures)};
    while (!states.back().empty() && states.size() < size) {
        states.push_back(next_states(postures, states.size(), states.back()));
    }
    if (states.back().empty()) {
        return Stop{states.size() - 1, ""};
    }
    const auto cheapest = std::min_element(states.back().begin(), states.back().end(),
                                           [](const State& a, const State& b) { return a.cost < b.cost; });
    Track way{std::vector<JointAngles>(size), std::vector<double>(size), 0};
    auto s = static_cast<std::size_t>(cheapest - states.back().begin());
    for (std::size_t k = size; k-- > 0;) {
        way.q[k] = states[k][s].q;
        way.roll[k] = postures.rolls()[states[k][s].roll];
        s = states[k][s].from;
    }
    smooth(postures, way);
    way.score = score_of(postures, way.q);
    return way;
}

}  // namespace seampath::planning
