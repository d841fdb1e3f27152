#include "stages/plan/arm_postures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "stages/angle.hpp"

namespace seampath::planning {
namespace {

// A posture this far from the limits, and with this share of the arm's best manipulability, is as good as any.
constexpr double kGoodMargin = 20 * kTurn / 360, kGoodDexterity = 0.1;

// Poses at the same time: the torch turns on the spot.
constexpr double kNoTime_s = 1e-9;

}  // namespace

Postures::Postures(const Chain& chain, const ArmCell& cell, const TrackOptions& options)
    : chain_(chain), cell_(cell), options_(options), tool_from_flange_(cell.flange_from_tool.inverse()) {
    const int steps = static_cast<int>(std::floor(options.max_roll / options.roll_step + 1e-9));
    for (int k = -steps; k <= steps; ++k) {
        // Both ends of a whole turn are the same.
        if (k > -steps || k == 0 || 2 * steps * options.roll_step < kTurn - 1e-9) {
            rolls_.push_back(k * options.roll_step);
        }
    }
    table_.resize(chain.size() * rolls_.size());
}

Eigen::Isometry3d Postures::flange(std::size_t pose, double roll) const {
    return chain_[pose].base_from_tool * Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()) * tool_from_flange_;
}

const std::vector<Posture>& Postures::at(std::size_t pose, std::size_t roll) {
    auto& entry = table_[pose * rolls_.size() + roll];
    if (!entry) {
        entry.emplace();
        for (const JointAngles& q : inverse(cell_.arm, flange(pose, rolls_[roll]))) {
            entry->push_back({q, dexterity(q)});
        }
    }
    return *entry;
}

std::optional<JointAngles> Postures::next(std::size_t pose, double roll, const JointAngles& before) const {
    std::optional<JointAngles> best;
    double least = std::numeric_limits<double>::infinity();
    for (const JointAngles& q : inverse(cell_.arm, flange(pose, roll), before)) {
        const JointAngles near = nearest_turns(q, before);
        const double step = (near - before).cwiseAbs().maxCoeff();
        if (step < least) {
            least = step;
            best = near;
        }
    }
    return best && may_step(pose, before, *best) ? best : std::nullopt;
}

double Postures::speed_share(std::size_t pose, const JointAngles& before, const JointAngles& q) const {
    const double time = pose > 0 ? chain_[pose].at.time_s - chain_[pose - 1].at.time_s : 0;
    double most = 0;
    for (int i = 0; time > kNoTime_s && i < kArmAxes; ++i) {
        most =
            std::max(most, std::abs(q[i] - before[i]) / time / cell_.arm.axes[static_cast<std::size_t>(i)].max_speed);
    }
    return most;
}

bool Postures::may_step(std::size_t pose, const JointAngles& before, const JointAngles& q) const {
    return (q - before).cwiseAbs().maxCoeff() <= options_.most_step && speed_share(pose, before, q) <= 1;
}

double goodness(double margin, double dexterity) {
    return std::clamp(std::min(margin / kGoodMargin, dexterity / kGoodDexterity), 0.0, 1.0);
}

double score_of(const Postures& postures, const std::vector<JointAngles>& q) {
    double worst = 1;
    for (std::size_t k = 0; k < q.size(); ++k) {
        worst = std::min(worst, goodness(limit_margin(postures.arm(), q[k]), postures.dexterity(q[k])));
        worst = k > 0 ? std::min(worst, 1 - postures.speed_share(k, q[k - 1], q[k])) : worst;
    }
    return worst;
}

Lifted lift(const Arm& arm, std::vector<JointAngles> q) {
    Lifted result{{}, q.size(), -1};
    for (int i = 0; i < kArmAxes; ++i) {
        const ArmAxis& axis = arm.axes[static_cast<std::size_t>(i)];
        double best_margin = -1, best_turns = 0;
        std::size_t furthest = 0;
        const auto [low, high] = std::minmax_element(
            q.begin(), q.end(), [i](const JointAngles& a, const JointAngles& b) { return a[i] < b[i]; });
        const double first = std::floor((axis.lowest - (*high)[i]) / kTurn),
                     last = std::ceil((axis.highest - (*low)[i]) / kTurn);
        for (double turns = first; turns <= last; ++turns) {
            const double move = turns * kTurn;
            const double margin = std::min((*low)[i] + move - axis.lowest, axis.highest - (*high)[i] - move);
            const auto outside = std::find_if(q.begin(), q.end(), [&](const JointAngles& a) {
                return a[i] + move < axis.lowest || a[i] + move > axis.highest;
            });
            furthest = std::max(furthest, static_cast<std::size_t>(outside - q.begin()));
            if (outside == q.end() && margin > best_margin) {
                best_margin = margin;
                best_turns = turns;
            }
        }
        if (furthest < q.size()) {
            if (furthest < result.stop) {
                result.stop = furthest;
                result.axis = i;
            }
            continue;
        }
        for (JointAngles& angles : q) {
            angles[i] += best_turns * kTurn;
        }
    }
    result.q = std::move(q);
    return result;
}

}  // namespace seampath::planning
