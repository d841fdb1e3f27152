#include "stages/plan/arm_shift.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "stages/plan/arm_ways.hpp"

namespace seampath::planning {
namespace {

constexpr double kFirst_mm = 10, kMost_mm = 2000, kFine_mm = 1;

// Of the thinned ways.
constexpr std::size_t kThinned = 16;
constexpr double kCoarseRoll = 30 * std::numbers::pi / 180, kCoarseStep = 0.6;

// How much further than the thinned ways ask for, when the whole ones need it.
constexpr double kMore_mm = 10;
constexpr int kTries = 4;

class Search {
public:
    Search(const std::vector<Waypoint>& waypoints, const ArmCell& cell, const PlanOptions& options)
        : cell_(cell), options_(track_options(cell.arm, options)) {
        options_.any = true;
        for (const auto& [first, last] : ways_of(waypoints)) {
            chains_.push_back(chain_of(waypoints, first, last, cell));
        }
    }

    /// Whether the arm makes thinned ways that are moved.
    bool helps(const Eigen::Vector3d& shift) const {
        TrackOptions coarse = options_;
        coarse.roll_step = std::max(options_.roll_step, std::min(kCoarseRoll, options_.max_roll));
        coarse.most_step = kCoarseStep;
        coarse.roll_may_change = false;
        return std::all_of(chains_.begin(), chains_.end(), [&](const Chain& chain) {
            const std::size_t every = std::max<std::size_t>(1, chain.size() / kThinned);
            Chain thinned;
            for (std::size_t k = 0; k < chain.size(); ++k) {
                if (k % every == 0 || k + 1 == chain.size()) {
                    thinned.push_back(moved(chain[k], shift));
                }
            }
            return std::holds_alternative<Track>(track(thinned, cell_, coarse));
        });
    }

    bool helps_fully(const Eigen::Vector3d& shift) const {
        return std::all_of(chains_.begin(), chains_.end(), [&](const Chain& chain) {
            Chain all;
            for (const ChainPose& pose : chain) {
                all.push_back(moved(pose, shift));
            }
            return std::holds_alternative<Track>(track(all, cell_, options_));
        });
    }

private:
    static ChainPose moved(ChainPose pose, const Eigen::Vector3d& shift) {
        pose.base_from_tool.pretranslate(shift);
        return pose;
    }

    const ArmCell& cell_;
    TrackOptions options_;
    std::vector<Chain> chains_;
};

std::vector<Eigen::Vector3d> directions() {
    std::vector<Eigen::Vector3d> all;
    for (int x = -1; x <= 1; ++x) {
        for (int y = -1; y <= 1; ++y) {
            for (int z = -1; z <= 1; ++z) {
                if (x != 0 || y != 0 || z != 0) {
                    all.push_back(Eigen::Vector3d(x, y, z).normalized());
                }
            }
        }
    }
    return all;
}

}  // namespace

std::optional<Eigen::Vector3d> helpful_shift(const std::vector<Waypoint>& waypoints, const ArmCell& cell,
                                             const PlanOptions& options) {
    const Search search(waypoints, cell, options);
    const std::vector<Eigen::Vector3d> all = directions();
    // All directions a little, then further: the first that helps bounds the others.
    double distance = kFirst_mm;
    std::vector<Eigen::Vector3d> helping;
    while (helping.empty() && distance < kMost_mm) {
        for (const Eigen::Vector3d& direction : all) {
            if (search.helps(distance * direction)) {
                helping.push_back(direction);
            }
        }
        distance *= helping.empty() ? 1.5 : 1;
    }
    Eigen::Vector3d best = Eigen::Vector3d::Zero();
    double least = distance + 1;
    for (const Eigen::Vector3d& direction : helping) {
        double low = 0, high = distance;
        while (high - low > kFine_mm && low < least) {
            const double middle = 0.5 * (low + high);
            (search.helps(middle * direction) ? high : low) = middle;
        }
        if (high < least) {
            least = high;
            best = direction;
        }
    }
    // The whole ways, which are tried at more rolls, may ask for more or for less.
    double low = 0, high = std::ceil(least);
    int tries = 0;
    while (!helping.empty() && !search.helps_fully(high * best)) {
        low = high;
        high += kMore_mm;
        if (++tries == kTries) {
            return std::nullopt;
        }
    }
    while (!helping.empty() && high - low > kFine_mm) {
        const double middle = 0.5 * (low + high);
        (search.helps_fully(middle * best) ? high : low) = middle;
    }
    return helping.empty() ? std::nullopt : std::optional<Eigen::Vector3d>(high * best);
}

}  // namespace seampath::planning
