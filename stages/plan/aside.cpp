#include "stages/plan/aside.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "stages/angle.hpp"
#include "stages/plan/text.hpp"

namespace seampath::planning {
namespace {

constexpr double kMostPlaces = 400;

// A turn about the wire is worth as much as a lean of a quarter of it, and may change four times as fast.
constexpr double kTurnWorth = 0.25;

// With a bent neck there are turns to try as well, and each look costs.
struct Fineness {
    double place_mm, lean, turn, most_turn;
};
constexpr Fineness kStraight{2.5, kDegree, kTurn, 0}, kBent{5, 2 * kDegree, 20 * kDegree, 100 * kDegree};

constexpr double kNever = std::numeric_limits<double>::infinity();

struct Aside {
    double lean, turn;
    double cost() const { return lean * lean + kTurnWorth * turn * kTurnWorth * turn; }
};

// The least first.
std::vector<Aside> choices(const Fineness& fine, const PlanOptions& o) {
    std::vector<Aside> all;
    const double leans = std::floor(o.max_free_angle_deg * kDegree / fine.lean + 1e-9);
    const double turns = std::round(fine.most_turn / fine.turn);
    for (double lean = -leans; lean <= leans; ++lean) {
        for (double turn = -turns; turn <= turns; ++turn) {
            all.push_back({lean * fine.lean, turn * fine.turn});
        }
    }
    std::stable_sort(all.begin(), all.end(), [](const Aside& a, const Aside& b) { return a.cost() < b.cost(); });
    return all;
}

class AsideSearch {
public:
    AsideSearch(const TorchPath& path, const Clearance& clearance, const PlanOptions& o)
        : path_(path), clearance_(clearance), o_(o) {
        const Fineness& fine = o.neck_angle_deg > 0 ? kBent : kStraight;
        choices_ = choices(fine, o);
        const double length = path.arc().length();
        // So far apart that the lean may change by a step from one to the next.
        const double place = std::max(fine.place_mm, fine.lean / (o.free_angle_rate_deg_mm * kDegree));
        const double places = std::clamp(std::ceil(length / place), 2.0, kMostPlaces);
        for (double k = 0; k <= places; ++k) {
            poses_.push_back(path.at_station(k == places ? length : length * k / places));
        }
    }

    bool free_as_it_is() const {
        return std::none_of(poses_.begin(), poses_.end(),
                            [&](const TorchPose& pose) { return clearance_.touches(pose.p, pose.q); });
    }

    /// The tables of the best way; nothing where there is none.
    bool find(AngleTable& lean, AngleTable& turn) {
        std::vector<double> cost(choices_.size(), 0);
        for (std::size_t place = 0; place < poses_.size(); ++place) {
            cost = step(place, cost);
            if (*std::min_element(cost.begin(), cost.end()) == kNever) {
                stopped_ = place;
                return false;
            }
        }
        auto at = static_cast<std::size_t>(std::min_element(cost.begin(), cost.end()) - cost.begin());
        for (std::size_t place = poses_.size(); place-- > 0;) {
            for (auto* table : {&lean, &turn}) {
                table->station_mm.insert(table->station_mm.begin(), poses_[place].station_mm);
            }
            lean.angle.insert(lean.angle.begin(), choices_[at].lean);
            turn.angle.insert(turn.angle.begin(), choices_[at].turn);
            at = from_[place][at];
        }
        return true;
    }

    SeamRefusal refusal() const {
        // Where even the best lean leaves the scan deepest in the torch; where each has one, the rate is what bars it.
        std::size_t worst = stopped_;
        double least = 0;
        for (std::size_t place = 0; place < poses_.size(); ++place) {
            const double depth = least_depth(poses_[place]);
            worst = depth > least ? place : worst;
            least = std::max(least, depth);
        }
        const TorchPose& pose = poses_[worst];
        const double station = path_.before_mm() + pose.station_mm;
        const std::string lean = "leaned aside by up to " + number(o_.max_free_angle_deg) + " deg";
        const std::string where = seam_text(path_.seam()) + " is refused: at station " + number(station) + " mm ";
        if (least > 0) {
            return {path_.seam(), station, least,
                    where + "the scan reaches " + number(least) + " mm into the torch with its clearance, " + lean +
                        "; a slimmer torch, a longer plan.stick_out_mm or another plan.work_angle_deg is needed"};
        }
        const double depth = clearance_.depth(pose.p, pose.q);
        return {path_.seam(), station, depth,
                where + "the scan reaches " + number(depth) + " mm into the torch with its clearance, and " + lean +
                    " and by no more than plan.free_angle_rate_deg_mm = " + number(o_.free_angle_rate_deg_mm) +
                    " it does not get past; a higher rate is needed, or another plan.work_angle_deg"};
    }

private:
    double least_depth(const TorchPose& pose) const {
        double least = kNever;
        for (auto aside = choices_.begin(); aside != choices_.end() && least > 0; ++aside) {
            least = std::min(least, clearance_.depth(pose.p, turned(pose, *aside), least));
        }
        return least;
    }

    Eigen::Quaterniond turned(const TorchPose& pose, const Aside& aside) const {
        // The lean turns about travel, which is +X of the middle's frame, before all else does.
        const Eigen::Vector3d travel = path_.middle(pose.u, pose.station_mm) * Eigen::Vector3d::UnitX();
        return (Eigen::AngleAxisd(aside.lean, travel) * pose.q *
                Eigen::AngleAxisd(aside.turn, Eigen::Vector3d::UnitZ()))
            .normalized();
    }

    // Costs of all choices at a place from those at the place before.
    std::vector<double> step(std::size_t place, const std::vector<double>& before) {
        const TorchPose& pose = poses_[place];
        const double way = place > 0 ? pose.station_mm - poses_[place - 1].station_mm : 0;
        const double most = o_.free_angle_rate_deg_mm * kDegree * way + 1e-12;
        std::vector<double> cost(choices_.size(), kNever);
        std::vector<std::size_t> from(choices_.size(), 0);
        for (std::size_t to = 0; to < choices_.size(); ++to) {
            const Aside& next = choices_[to];
            for (std::size_t k = 0; k < choices_.size(); ++k) {
                const Aside& last = choices_[k];
                const Aside change{next.lean - last.lean, next.turn - last.turn};
                const bool may =
                    place == 0 ? k == to : std::abs(change.lean) <= most && kTurnWorth * std::abs(change.turn) <= most;
                const double total = before[k] + next.cost() + (place == 0 ? 0 : change.cost());
                if (may && total < cost[to]) {
                    cost[to] = total;
                    from[to] = k;
                }
            }
            if (cost[to] < kNever && clearance_.touches(pose.p, turned(pose, next))) {
                cost[to] = kNever;
            }
        }
        from_.push_back(std::move(from));
        return cost;
    }

    const TorchPath& path_;
    const Clearance& clearance_;
    const PlanOptions& o_;
    std::vector<Aside> choices_;
    std::vector<TorchPose> poses_;
    std::vector<std::vector<std::size_t>> from_;
    std::size_t stopped_ = 0;
};

}  // namespace

std::optional<SeamRefusal> hold_clear(TorchPath& path, const Clearance& clearance, const PlanOptions& options) {
    AsideSearch search(path, clearance, options);
    if (search.free_as_it_is()) {
        return std::nullopt;
    }
    AngleTable lean, turn;
    if (!search.find(lean, turn)) {
        return search.refusal();
    }
    path.hold_aside(std::move(lean), std::move(turn));
    return std::nullopt;
}

}  // namespace seampath::planning
