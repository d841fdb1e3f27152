#include "stages/mechanism/optimal.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <unordered_map>

#include "stages/error.hpp"

namespace seampath::mechanism {
namespace {

using Eigen::Vector2d;

/// A node of the corridor.
struct Place {
    GridNode node;
    double square = 0;  ///< distance from the line, squared
    double to_end = 0;
};

constexpr auto kNone = std::numeric_limits<std::uint32_t>::max();

/// The centre is one place, whatever alpha.
bool same_place(GridNode a, GridNode b) {
    return a.j == b.j && (a.j == 0 || a.i == b.i);
}

/// All that can be reached from the start within the corridor.
class Corridor {
public:
    Corridor(const GridSegment& segment, const std::vector<GridNode>& greedy, Neighbours neighbours)
        : segment_(segment), goal_(greedy.back()) {
        double widest = 0, longest = 0;
        for (std::size_t k = 0; k < greedy.size(); ++k) {
            const Vector2d p = seampath::position(segment.grid(), greedy[k]);
            widest = std::max(widest, segment.distance_from_line(p));
            longest = std::max(longest, k > 0 ? (p - seampath::position(segment.grid(), greedy[k - 1])).norm() : 0);
        }
        half_width_ = 2 * widest + longest;
        index_of(greedy.front(), 0, segment.distance_to_end(seampath::position(segment.grid(), greedy.front())));
        for (std::size_t k = 0; k < places_.size(); ++k) {  // which grows
            first_link_.push_back(links_.size());
            if (same_place(places_[k].node, goal_)) {
                end_ = static_cast<std::uint32_t>(k);
            } else {
                add_links(places_[k].node, neighbours);
            }
        }
        first_link_.push_back(links_.size());
        order_.resize(places_.size());
        std::iota(order_.begin(), order_.end(), std::uint32_t{0});
        std::sort(order_.begin(), order_.end(), [this](std::uint32_t a, std::uint32_t b) {
            return places_[a].to_end != places_[b].to_end ? places_[a].to_end < places_[b].to_end : a < b;
        });
    }

    /// The way with the least sum of (square - lambda) over the nodes between both ends.
    std::vector<GridNode> best(double lambda) const {
        std::vector<double> cost(places_.size(), std::numeric_limits<double>::infinity());
        std::vector<std::uint32_t> then(places_.size(), kNone);
        for (const std::uint32_t k : order_) {  // nearest to the end first: all that follow from k are known
            if (k == end_) {
                cost[k] = 0;
                continue;
            }
            for (std::size_t link = first_link_[k]; link < first_link_[k + 1]; ++link) {
                const std::uint32_t n = links_[link];
                const double through = cost[n] + (n == end_ ? 0 : places_[n].square - lambda);
                if (through < cost[k]) {
                    cost[k] = through;
                    then[k] = n;
                }
            }
        }
        std::vector<GridNode> way{places_.front().node};
        for (std::uint32_t k = then.front(); k != kNone; k = then[k]) {
            const GridNode node = places_[k].node;
            way.push_back(node.j == 0 ? GridNode{way.back().i, 0} : node);
        }
        ensure(same_place(way.back(), goal_), "the greedy way itself lies in the corridor");
        return way;
    }

private:
    /// Where one can go on from a node, within the corridor.
    void add_links(GridNode node, Neighbours neighbours) {
        segment_.for_nearer_neighbours(node, neighbours, [&](GridNode n, const Vector2d& p, double to_end) {
            const double distance = segment_.distance_from_line(p);
            if (distance <= half_width_) {
                links_.push_back(index_of(n, distance * distance, to_end));
            }
        });
    }

    std::uint32_t index_of(GridNode node, double square, double to_end) {
        const auto key = static_cast<std::int64_t>(node.j) * segment_.grid().alpha_steps + (node.j == 0 ? 0 : node.i);
        const auto [found, is_new] = index_.emplace(key, static_cast<std::uint32_t>(places_.size()));
        if (is_new) {
            ensure(places_.size() < kNone, "as many nodes as can be counted");
            places_.push_back({node, square, to_end});
        }
        return found->second;
    }

    const GridSegment& segment_;
    GridNode goal_;
    std::uint32_t end_ = kNone;  ///< its place
    double half_width_ = 0;
    std::vector<Place> places_;            ///< the start first
    std::vector<std::size_t> first_link_;  ///< of each place, into links_; one more at the end
    std::vector<std::uint32_t> links_;     ///< places that one can go on to
    std::vector<std::uint32_t> order_;     ///< of the places, by their distance from M2
    std::unordered_map<std::int64_t, std::uint32_t> index_;
};

double mean_square(const GridSegment& segment, const std::vector<GridNode>& way) {
    double sum = 0;
    for (std::size_t k = 1; k + 1 < way.size(); ++k) {
        const double distance = segment.distance_from_line(seampath::position(segment.grid(), way[k]));
        sum += distance * distance;
    }
    return sum / static_cast<double>(way.size() - 2);
}

}  // namespace

std::vector<GridNode> optimal_way(const GridSegment& segment, const std::vector<GridNode>& greedy,
                                  Neighbours neighbours) {
    std::vector<GridNode> way = greedy;
    if (way.size() <= 2) {
        return way;
    }
    const Corridor corridor(segment, greedy, neighbours);
    double lambda = mean_square(segment, way);
    while (true) {
        std::vector<GridNode> better = corridor.best(lambda);
        if (better.size() <= 2) {
            return better;
        }
        const double mean = mean_square(segment, better);
        if (!(mean < lambda * (1 - 1e-14))) {
            return way;
        }
        lambda = mean;
        way = std::move(better);
    }
}

}  // namespace seampath::mechanism
