#include "stages/plan/order.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "stages/plan/stretch.hpp"
#include "stages/plan/torch.hpp"

namespace seampath::planning {
namespace {

using Eigen::Vector3d;
using Order = std::vector<std::size_t>;

constexpr int kStarts = 12;

// Sums that the exact way may look at: some tenths of a second.
constexpr double kMostSums = 3e7;

constexpr double kUnreached = std::numeric_limits<double>::infinity();
constexpr double kBetter = 1e-9;

/// One way to weld a seam: where the torch comes to it and leaves it.
struct SeamWay {
    PlanOptions options;
    Vector3d approach, retract;
};
using SeamWays = std::vector<std::vector<SeamWay>>;  // of each seam

SeamWay way_of(const SeamModel& model, int seam, const PlanOptions& o) {
    const SeamModel way = whole_way(model, seam, o);
    const TorchPath path(way, seam, o);
    const TorchPose start = path.at_station(0), end = path.at_station(path.arc().length());
    return {o, start.p - o.approach_mm * (start.q * Vector3d::UnitZ()),
            end.p - o.retract_mm * (end.q * Vector3d::UnitZ())};
}

std::vector<SeamWay> ways_of_seam(const SeamModel& model, int seam, const PlanOptions& o) {
    std::vector<SeamWay> ways{way_of(model, seam, o)};
    PlanOptions other = o;
    if (model.closed && o.order_moves_starts) {
        for (int k = 1; k < kStarts; ++k) {
            other.start_station_mm = std::fmod(o.start_station_mm + model.length_mm * k / kStarts, model.length_mm);
            ways.push_back(way_of(model, seam, other));
        }
    } else if (!model.closed && o.order_turns_seams) {
        other.backwards = !o.backwards;
        ways.push_back(way_of(model, seam, other));
    }
    return ways;
}

double between_ways(const SeamWay& a, const SeamWay& b) {
    return (b.approach - a.retract).norm();
}

/// The best way of each seam in an order, and the sum.
struct ChosenWays {
    std::vector<std::size_t> way;  // one a place of the order
    double sum = 0;
};
ChosenWays best_ways(const SeamWays& ways, const Order& order) {
    std::vector<double> cost(ways[order.front()].size(), 0);
    std::vector<std::vector<std::size_t>> from;
    for (std::size_t k = 1; k < order.size(); ++k) {
        const auto &last = ways[order[k - 1]], &next = ways[order[k]];
        std::vector<double> sums(next.size(), kUnreached);
        from.emplace_back(next.size(), 0);
        for (std::size_t b = 0; b < next.size(); ++b) {
            for (std::size_t a = 0; a < last.size(); ++a) {
                const double sum = cost[a] + between_ways(last[a], next[b]);
                if (sum < sums[b]) {
                    sums[b] = sum;
                    from.back()[b] = a;
                }
            }
        }
        cost = std::move(sums);
    }
    const auto least = std::min_element(cost.begin(), cost.end());
    ChosenWays choice{std::vector<std::size_t>(order.size()), *least};
    auto way = static_cast<std::size_t>(least - cost.begin());
    for (std::size_t k = order.size(); k-- > 0;) {
        choice.way[k] = way;
        way = k > 0 ? from[k - 1][way] : 0;
    }
    return choice;
}

// Over all sets of seams that are done, and the last one of them in each of its ways.
Order exact_order(const SeamWays& ways) {
    const std::size_t n = ways.size(), sets = std::size_t{1} << n;
    std::vector<std::size_t> first{0};
    for (const auto& seam : ways) {
        first.push_back(first.back() + seam.size());
    }
    const std::size_t all = first.back();
    std::vector<double> cost(sets * all, kUnreached);
    std::vector<std::size_t> from(sets * all, 0);
    for (std::size_t seam = 0; seam < n; ++seam) {
        std::fill_n(cost.begin() + static_cast<std::ptrdiff_t>((std::size_t{1} << seam) * all + first[seam]),
                    ways[seam].size(), 0.0);
    }
    for (std::size_t set = 1; set < sets; ++set) {
        for (std::size_t last = 0; last < n; ++last) {
            for (std::size_t a = 0; a < ways[last].size(); ++a) {
                const double so_far = cost[set * all + first[last] + a];
                for (std::size_t next = 0; so_far < kUnreached && next < n; ++next) {
                    if ((set >> next & 1) != 0) {
                        continue;
                    }
                    const std::size_t then = (set | std::size_t{1} << next) * all + first[next];
                    for (std::size_t b = 0; b < ways[next].size(); ++b) {
                        const double sum = so_far + between_ways(ways[last][a], ways[next][b]);
                        if (sum < cost[then + b]) {
                            cost[then + b] = sum;
                            from[then + b] = first[last] + a;
                        }
                    }
                }
            }
        }
    }
    Order order;
    const auto end = cost.end() - static_cast<std::ptrdiff_t>(all);
    auto at = static_cast<std::size_t>(std::min_element(end, cost.end()) - end);
    for (std::size_t set = sets - 1; set != 0;) {
        const auto seam =
            static_cast<std::size_t>(std::upper_bound(first.begin(), first.end(), at) - first.begin()) - 1;
        order.insert(order.begin(), seam);
        at = from[set * all + at];
        set &= ~(std::size_t{1} << seam);
    }
    return order;
}

Order nearest_neighbours(const SeamWays& ways, std::size_t start) {
    Order order{start}, left(ways.size());
    std::iota(left.begin(), left.end(), 0);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(start));
    while (!left.empty()) {
        const auto distance = [&](std::size_t seam) {
            double least = kUnreached;
            for (const SeamWay& a : ways[order.back()]) {
                for (const SeamWay& b : ways[seam]) {
                    least = std::min(least, between_ways(a, b));
                }
            }
            return least;
        };
        const auto next = std::min_element(left.begin(), left.end(),
                                           [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); });
        order.push_back(*next);
        left.erase(next);
    }
    return order;
}

// Reverses runs and moves single seams while that helps.
void improve(const SeamWays& ways, Order& order) {
    double sum = best_ways(ways, order).sum;
    const auto take = [&](const Order& other) {
        const double its = best_ways(ways, other).sum;
        const bool better = its < sum - kBetter;
        if (better) {
            sum = its;
            order = other;
        }
        return better;
    };
    for (bool better = true; better;) {
        better = false;
        for (std::size_t i = 0; i < order.size(); ++i) {
            for (std::size_t k = 0; k < order.size(); ++k) {
                Order other = order;
                const auto at = [&other](std::size_t place) {
                    return other.begin() + static_cast<std::ptrdiff_t>(place);
                };
                if (i < k) {
                    std::reverse(at(i), at(k) + 1);
                    better = take(other) || better;
                    other = order;
                    std::rotate(at(i), at(i) + 1, at(k) + 1);
                } else {
                    std::rotate(at(k), at(i), at(i) + 1);
                }
                better = (i != k && take(other)) || better;
            }
        }
    }
}

Order shortest_order(const SeamWays& ways) {
    double all = 0;
    for (const auto& seam : ways) {
        all += static_cast<double>(seam.size());
    }
    if (std::pow(2.0, static_cast<double>(ways.size())) * all * all <= kMostSums) {
        return exact_order(ways);
    }
    Order best;
    for (std::size_t start = 0; start < ways.size(); ++start) {
        const Order order = nearest_neighbours(ways, start);
        if (best.empty() || best_ways(ways, order).sum < best_ways(ways, best).sum - kBetter) {
            best = order;
        }
    }
    improve(ways, best);
    return best;
}

}  // namespace

std::vector<Visit> visits(std::span<const SeamModel> models, const PlanOptions& options) {
    std::vector<Visit> result;
    if (options.order == SeamOrder::found || models.size() < 2) {
        for (std::size_t i = 0; i < models.size(); ++i) {
            result.push_back({static_cast<int>(i), options});
        }
        return result;
    }
    SeamWays ways;
    for (std::size_t i = 0; i < models.size(); ++i) {
        ways.push_back(ways_of_seam(models[i], static_cast<int>(i), options));
    }
    const Order order = shortest_order(ways);
    const ChosenWays choice = best_ways(ways, order);
    for (std::size_t k = 0; k < order.size(); ++k) {
        result.push_back({static_cast<int>(order[k]), ways[order[k]][choice.way[k]].options});
    }
    return result;
}

}  // namespace seampath::planning
