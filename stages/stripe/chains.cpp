#include "stages/stripe/chains.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace seampath {
namespace {

constexpr int kMostMissing = 5;       // columns without a bar inside a chain: speckle
constexpr float kSteepest = 2.1F;     // rows a column: 65 degrees
constexpr std::size_t kShortest = 8;  // links of a chain, or twice its bars' height

/// A chain at work.
struct Track {
    Chain chain;
    float slope = 0;  ///< rows a column
    bool open = true;

    const ChainLink& last() const { return chain.links.back(); }

    /// How far the bar is from where the chain goes on; more than 1 is another chain's.
    float distance(int column, const Bar& bar) const {
        const float steps = static_cast<float>(column - last().column);
        const float reach = 1 + 0.5F * std::min(bar.height, last().bar.height);
        const float off = std::abs(bar.y - last().bar.y - slope * steps);
        const bool steep = std::abs(bar.y - last().bar.y) > kSteepest * steps + 1;
        return steep ? 2 : off / (reach + 0.5F * (steps - 1));
    }

    void add(int column, const Bar& bar) {
        constexpr float kGain = 0.2F;  // a slope from about five columns
        const float seen = (bar.y - last().bar.y) / static_cast<float>(column - last().column);
        slope = std::clamp(slope + kGain * (seen - slope), -kSteepest, kSteepest);
        chain.links.push_back({column, bar});
    }
};

struct Pair {
    float distance;
    std::size_t track, bar;
};

/// The bars of one column to the tracks that they fit best, the closest pairs first; the others begin tracks.
void extend(std::vector<Track>& tracks, std::vector<std::size_t>& open, int column, const std::vector<Bar>& bars) {
    std::vector<Pair> pairs;
    for (const std::size_t t : open) {
        for (std::size_t b = 0; b < bars.size(); ++b) {
            const float distance = tracks[t].distance(column, bars[b]);
            if (distance <= 1) {
                pairs.push_back({distance, t, b});
            }
        }
    }
    std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.distance < b.distance; });
    std::vector<char> taken(bars.size(), 0);
    for (const Pair& pair : pairs) {
        if (!taken[pair.bar] && tracks[pair.track].last().column < column) {
            tracks[pair.track].add(column, bars[pair.bar]);
            taken[pair.bar] = 1;
        }
    }
    for (std::size_t b = 0; b < bars.size(); ++b) {
        if (!taken[b]) {
            open.push_back(tracks.size());
            tracks.push_back({{{{column, bars[b]}}}});
        }
    }
    std::erase_if(open, [&](std::size_t t) { return column - tracks[t].last().column > kMostMissing; });
}

double sum_of_contrast(const Chain& chain) {
    return std::accumulate(chain.links.begin(), chain.links.end(), 0.0,
                           [](double sum, const ChainLink& link) { return sum + link.bar.contrast; });
}

/// Rows a column at one end, over about two heights of the bar there.
double end_slope(const Chain& chain, bool at_end) {
    const auto& links = chain.links;
    const ChainLink& end = at_end ? links.back() : links.front();
    const std::size_t reach = std::min(links.size() - 1, static_cast<std::size_t>(2 * end.bar.height) + 4);
    const ChainLink& inner = at_end ? links[links.size() - 1 - reach] : links[reach];
    return (end.bar.y - inner.bar.y) / (end.column - inner.column);
}

/// Rows between the end of a chain and the beginning of the next, as they are or after both are drawn out to meet.
double jump_between(const Chain& from, const Chain& to) {
    const ChainLink &a = from.links.back(), &b = to.links.front();
    const double columns = b.column - a.column, rows = b.bar.y - a.bar.y;
    const double ahead = std::abs(rows - columns * end_slope(from, true));
    const double back = std::abs(rows - columns * end_slope(to, false));
    return std::min(std::abs(rows), std::max(ahead, back));
}

/// The last of the chains that make the best line with this one at its end, and what that line says: the sum of
/// contrasts, less, for each jump, that of as many columns as it has rows: light that ought to have been seen.
struct BestLine {
    double gain = 0;
    std::optional<std::size_t> before;
};

/// The best line of all chains, by dynamic programming over their order from left to right; ends may overlap a little,
/// at steps and crossings. Indices in that order.
std::vector<std::size_t> best_line(const std::vector<Chain>& chains) {
    constexpr double kMostOverlap = 0.3;  // of the shorter chain
    std::vector<BestLine> best(chains.size());
    std::size_t top = 0;
    for (std::size_t i = 0; i < chains.size(); ++i) {
        const auto& links = chains[i].links;
        const double contrast = median_of(chains[i], &Bar::contrast);
        const double own = sum_of_contrast(chains[i]);
        best[i].gain = own;
        for (std::size_t k = 0; k < i; ++k) {
            const auto& others = chains[k].links;
            const double overlap = std::max(0, others.back().column - links.front().column + 1);
            const double shorter = static_cast<double>(std::min(links.size(), others.size()));
            if (overlap > kMostOverlap * shorter || links.back().column <= others.back().column) {
                continue;
            }
            const double gain = best[k].gain + own - contrast * (overlap + jump_between(chains[k], chains[i]));
            if (gain > best[i].gain) {
                best[i] = {gain, k};
            }
        }
        top = best[i].gain > best[top].gain ? i : top;
    }
    std::vector<std::size_t> line;
    for (std::optional<std::size_t> i = top; i; i = best[*i].before) {
        line.push_back(*i);
    }
    return {line.rbegin(), line.rend()};
}

/// One chain of several from left to right; of bars in one column that of the earlier chain.
Chain joined(const std::vector<Chain>& chains, const std::vector<std::size_t>& line) {
    Chain all;
    for (const std::size_t i : line) {
        for (const ChainLink& link : chains[i].links) {
            if (all.links.empty() || link.column > all.links.back().column) {
                all.links.push_back(link);
            }
        }
    }
    return all;
}

}  // namespace

double median_of(const Chain& chain, float Bar::*number) {
    std::vector<float> values;
    for (const ChainLink& link : chain.links) {
        values.push_back(link.bar.*number);
    }
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

std::vector<Chain> link_bars(const std::vector<std::vector<Bar>>& columns, double sure) {
    std::vector<Track> tracks;
    std::vector<std::size_t> open;
    for (std::size_t c = 0; c < columns.size(); ++c) {
        extend(tracks, open, static_cast<int>(c), columns[c]);
    }
    std::vector<Chain> chains;
    for (Track& track : tracks) {
        const auto& links = track.chain.links;
        const bool strong =
            std::any_of(links.begin(), links.end(), [&](const ChainLink& link) { return link.bar.strength >= sure; });
        if (strong && links.size() >= kShortest &&
            static_cast<double>(links.size()) >= 2 * median_of(track.chain, &Bar::height)) {
            chains.push_back(std::move(track.chain));
        }
    }
    return chains;
}

std::vector<Chain> choose_lines(std::vector<Chain> chains, int count) {
    constexpr double kFaintest = 0.1;  // of the brightest line's contrast
    std::stable_sort(chains.begin(), chains.end(),
                     [](const Chain& a, const Chain& b) { return a.links.front().column < b.links.front().column; });
    std::vector<Chain> lines;
    while (!chains.empty() && lines.size() < static_cast<std::size_t>(count)) {
        const std::vector<std::size_t> line = best_line(chains);
        Chain chain = joined(chains, line);
        const double contrast = median_of(chain, &Bar::contrast);
        if (!lines.empty() && contrast < kFaintest * median_of(lines.front(), &Bar::contrast)) {
            break;
        }
        lines.push_back(std::move(chain));
        for (const std::size_t i : line) {
            chains[i].links.clear();
        }
        std::erase_if(chains, [&](const Chain& other) {
            return other.links.empty() || median_of(other, &Bar::contrast) < kFaintest * contrast;
        });
    }
    return lines;
}

}  // namespace seampath
