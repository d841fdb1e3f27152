#include "stages/extract/consistent.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <queue>
#include <tuple>
#include <utility>

namespace seampath::detail {
namespace {

constexpr float kSheet = 0.1F;       // a link that costs less is within a sheet
constexpr std::size_t kLarge = 100;  // surfels; less is no more than a strip along an edge

struct Link {
    float cost;
    std::uint32_t a, b;
    float agree;  // cosine between their normals once moved together, below 0 where they point to different sides; less
                  // where one lies before the other, since noise and facing walls say the contrary of each other there
    bool operator<(const Link& o) const { return std::tie(cost, a, b) < std::tie(o.cost, o.a, o.b); }
};

// Disjoint sets in which each element knows whether its normal is turned against that of its set's root.
class TurnedSets {
public:
    explicit TurnedSets(std::size_t n) : parent_(n), turned_(n, 0) { std::iota(parent_.begin(), parent_.end(), 0u); }
    std::pair<std::uint32_t, bool> find(std::uint32_t i) {
        std::uint32_t root = i;
        bool turned = false;
        while (parent_[root] != root) {
            turned ^= turned_[root] != 0;
            root = parent_[root];
        }
        bool rest = turned;
        while (parent_[i] != root && i != root) {
            const std::uint32_t up = parent_[i];
            const bool own = turned_[i] != 0;
            parent_[i] = root;
            turned_[i] = rest;
            rest ^= own;
            i = up;
        }
        return {root, turned};
    }
    void join(std::uint32_t a, std::uint32_t b, bool opposite) {
        auto [ra, ta] = find(a);
        auto [rb, tb] = find(b);
        if (ra != rb) {
            if (ra > rb) {
                std::swap(ra, rb);
            }
            parent_[rb] = ra;
            turned_[rb] = (ta != tb) != opposite;
        }
    }

private:
    std::vector<std::uint32_t> parent_;
    std::vector<char> turned_;
};

// All pairs of surfels that touch, the least bent first.
std::vector<Link> links_of(const Surfels& surfels) {
    const std::vector<Surfel>& at = surfels.at;
    std::vector<Link> links;
    for (std::uint32_t a = 0; a < at.size(); ++a) {
        for (const std::uint32_t b : surfels.next[a]) {
            if (b > a && at[a].n.squaredNorm() > 0 && at[b].n.squaredNorm() > 0) {
                // Along an arc from one to the other a normal is mirrored by the plane between them. So are those of
                // walls that face each other, and of both faces of a thin one.
                const Eigen::Vector3d d = (at[b].p - at[a].p).normalized();
                const double along = at[a].n.dot(d), agree = (at[a].n - 2 * along * d).dot(at[b].n);
                // Steps within a sheet are cheap, steps from one face of a thin wall to the other dear.
                const double bend = 1 - std::min(std::abs(at[a].n.dot(at[b].n)), std::abs(agree));
                const double off_sheet = std::abs(along) + std::abs(at[b].n.dot(d));
                links.push_back({static_cast<float>(bend + 0.5 * off_sheet), a, b,
                                 static_cast<float>(agree * (1 - 0.5 * off_sheet))});
            }
        }
    }
    std::sort(links.begin(), links.end());
    return links;
}

// Joins sheets two at a time, those whose touching places say most clearly how they lie to each other first; what the
// places say of two sheets that are joined counts together from then on. Sheets that hardly touch for their size, as
// plates on both sides of a gap, stay apart.
class SheetJoiner {
public:
    // `links` that are no part of a sheet.
    SheetJoiner(TurnedSets& sets, std::size_t surfels, std::span<const Link> links) : sets_(sets), size_(surfels, 0) {
        for (std::uint32_t i = 0; i < surfels; ++i) {
            size_[sets_.find(i).first] += 1;
        }
        for (const Link& link : links) {
            const auto [a, a_turned] = sets_.find(link.a);
            const auto [b, b_turned] = sets_.find(link.b);
            if (a != b) {
                const double vote = (a_turned != b_turned ? -1 : 1) * link.agree / (0.1 + link.cost);
                votes_[a][b] += vote;
                votes_[b][a] += vote;
            }
        }
    }

    void join() {
        for (const auto& [a, others] : votes_) {
            for (const auto& [b, vote] : others) {
                if (a < b) {
                    next_.emplace(std::abs(vote), a, b);
                }
            }
        }
        while (!next_.empty()) {
            const auto [clearness, a, b] = next_.top();
            next_.pop();
            const auto found = votes_.find(a);
            if (found != votes_.end() && found->second.contains(b) && std::abs(found->second[b]) == clearness &&
                clearness > kTouching * std::sqrt(std::min(size_[a], size_[b]))) {
                found->second.size() >= votes_[b].size() ? merge(a, b) : merge(b, a);
            }
        }
    }

private:
    static constexpr double kTouching = 0.03;  // of a border as long as the root of the sheet's surfels

    // The votes of `from` go over to `into`, said of its own first surfel.
    void merge(std::uint32_t into, std::uint32_t from) {
        auto& kept = votes_[into];
        const bool opposite = kept[from] < 0;
        sets_.join(into, from, opposite);
        size_[into] += size_[from];
        for (const auto& [other, vote] : votes_[from]) {
            if (other == into) {
                continue;
            }
            const double sum = kept[other] += opposite ? -vote : vote;
            votes_[other].erase(from);
            votes_[other][into] = sum;
            next_.emplace(std::abs(sum), std::min(into, other), std::max(into, other));
        }
        kept.erase(from);
        votes_.erase(from);
    }

    TurnedSets& sets_;
    std::vector<double> size_;                                        // surfels, by the first of a sheet
    std::map<std::uint32_t, std::map<std::uint32_t, double>> votes_;  // of pairs of sheets, by their first surfels
    std::priority_queue<std::tuple<double, std::uint32_t, std::uint32_t>> next_;
};

}  // namespace

void make_consistent(Surfels& surfels) {
    const std::vector<Link> links = links_of(surfels);
    TurnedSets sets(surfels.at.size());
    std::vector<std::size_t> size(surfels.at.size(), 1);
    std::vector<Link> between;
    for (const Link& link : links) {
        const std::uint32_t a = sets.find(link.a).first, b = sets.find(link.b).first;
        if (a != b && link.cost > kSheet && std::min(size[a], size[b]) > kLarge) {
            between.push_back(link);
        } else if (a != b) {
            sets.join(link.a, link.b, link.agree < 0);
            size[std::min(a, b)] = size[a] + size[b];
        }
    }
    SheetJoiner(sets, surfels.at.size(), between).join();
    for (std::uint32_t i = 0; i < surfels.at.size(); ++i) {
        const auto [root, turned] = sets.find(i);
        surfels.at[i].piece = root;
        if (turned) {
            surfels.at[i].n = -surfels.at[i].n;
        }
    }
}

}  // namespace seampath::detail
