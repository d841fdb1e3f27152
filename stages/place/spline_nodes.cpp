#include "stages/place/spline_nodes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace seampath {
namespace {

constexpr double kRoundingMm = 1e-9;  // of lengths against their bounds

std::size_t fewest_feet(const SmoothLine& line, const PlaceOptions& o) {
    const auto intervals = static_cast<std::size_t>(std::ceil((line.length - kRoundingMm) / o.max_spacing_mm));
    return std::min(line.s.size(), std::max<std::size_t>(line.closed ? 4 : 2, intervals + (line.closed ? 0 : 1)));
}

/// Length of the k-th interval of chosen feet.
double length_of(const SmoothLine& line, const Chosen& c, std::size_t k) {
    return k + 1 < c.foot.size() ? line.s[c.foot[k + 1]] - line.s[c.foot[k]]
                                 : line.s[c.foot.front()] + line.length - line.s[c.foot[k]];
}

/// Whether there is a foot inside the k-th interval.
bool divisible(const SmoothLine& line, const Chosen& c, std::size_t k) {
    return (k + 1 < c.foot.size() ? c.foot[k + 1] : c.foot.front() + line.s.size()) > c.foot[k] + 1;
}

bool holds(const SmoothLine& line, const Chosen& c, std::size_t k, const PlaceOptions& o) {
    return c.error[k] <= o.spline_tolerance_mm &&
           (length_of(line, c, k) <= o.max_spacing_mm + kRoundingMm || !divisible(line, c, k));
}

bool holds(const SmoothLine& line, const Chosen& c, const PlaceOptions& o) {
    for (std::size_t k = 0; k < c.error.size(); ++k) {
        if (!holds(line, c, k, o)) {
            return false;
        }
    }
    return true;
}

/// The feet nearest to where the sum of the shares, each of an interval between feet, passes `shift` and every whole
/// number beyond it. Shares sum up to the number of intervals that are wanted.
std::vector<std::size_t> by_share(const SmoothLine& line, const std::vector<double>& share, double shift) {
    const std::size_t intervals =
        static_cast<std::size_t>(std::lround(std::accumulate(share.begin(), share.end(), 0.0)));
    std::vector<std::size_t> foot;
    double sum = 0;
    for (std::size_t k = 0; k < share.size(); ++k) {
        const double next = sum + share[k];
        while (foot.size() < intervals && static_cast<double>(foot.size()) + shift < next) {
            const double due = static_cast<double>(foot.size()) + shift - sum;
            const std::size_t nearest = (k + (due > 0.5 * share[k] ? 1 : 0)) % line.s.size();
            foot.push_back(nearest);
        }
        sum = next;
    }
    if (!line.closed) {
        foot.push_back(line.s.size() - 1);
    }
    std::sort(foot.begin(), foot.end());
    foot.erase(std::unique(foot.begin(), foot.end()), foot.end());
    return foot;
}

/// Without feet that lie nearer to the one before than the least spacing; the ends of an open line stay.
std::vector<std::size_t> spaced(const SmoothLine& line, const std::vector<std::size_t>& foot, const PlaceOptions& o) {
    const double end = line.closed ? line.s[foot.front()] + line.length : line.length;
    std::vector<std::size_t> kept{foot.front()};
    for (std::size_t k = 1; k < foot.size(); ++k) {
        const double s = line.s[foot[k]];
        const bool is_end = !line.closed && k + 1 == foot.size();
        const bool fits = s - line.s[kept.back()] >= o.min_spacing_mm - kRoundingMm;
        if (is_end || (fits && end - s >= o.min_spacing_mm - kRoundingMm)) {
            kept.push_back(foot[k]);
        }
    }
    return kept;
}

/// The most nodes that the least spacing leaves room for.
std::size_t most_feet(const SmoothLine& line, const PlaceOptions& o) {
    const double room = o.min_spacing_mm > 0 ? line.length / o.min_spacing_mm + kRoundingMm : 1e9;
    const auto intervals = static_cast<std::size_t>(std::min(room, static_cast<double>(line.s.size())));
    return std::max(fewest_feet(line, o), std::min(line.s.size(), intervals + (line.closed ? 0 : 1)));
}

/// Shares by length, for so many nodes at equal steps.
std::vector<double> equal_shares(const SmoothLine& line, std::size_t count) {
    const double step = line.length / static_cast<double>(line.closed ? count : count - 1);
    std::vector<double> share;
    for (std::size_t k = 0; k < line.weight.size(); ++k) {
        share.push_back((station_of(line, k + 1) - line.s[k]) / step);
    }
    return share;
}

/// Shares of so many intervals in proportion to the weights, within the bounds on the spacing.
std::vector<double> shares(const SmoothLine& line, const std::vector<double>& weight, std::size_t intervals,
                           const PlaceOptions& o) {
    constexpr int kBisections = 60;
    std::vector<double> share(weight.size());
    const auto sum_at = [&](double log_scale) {
        double sum = 0;
        for (std::size_t k = 0; k < weight.size(); ++k) {
            const double length = station_of(line, k + 1) - line.s[k];
            share[k] = std::max(std::exp(log_scale) * weight[k], length / o.max_spacing_mm);
            share[k] = o.min_spacing_mm > 0 ? std::min(share[k], length / o.min_spacing_mm) : share[k];
            sum += share[k];
        }
        return sum;
    };
    const double all = std::accumulate(weight.begin(), weight.end(), 0.0);
    double high = std::log(static_cast<double>(intervals) / all) + 1, low = high - 50;
    for (int rise = 0; rise < kBisections && sum_at(high) < static_cast<double>(intervals); ++rise) {
        high += 1;  // the least spacing takes from where the weights are large
    }
    for (int bisection = 0; bisection < kBisections; ++bisection) {
        const double middle = 0.5 * (low + high);
        (sum_at(middle) < static_cast<double>(intervals) ? low : high) = middle;
    }
    const double sum = sum_at(high);
    for (double& x : share) {
        x *= static_cast<double>(intervals) / sum;
    }
    return share;
}

/// Weights whose sum in each interval is the fourth root of the error found there.
void learn(const Chosen& c, std::vector<double>& weight) {
    constexpr double kLeastError = 1e-3;  // of the largest: where there is next to none, its root says little
    for (std::size_t k = 0; k < c.error.size(); ++k) {
        const std::size_t from = c.foot[k], n = weight.size();
        const std::size_t to = k + 1 < c.foot.size() ? c.foot[k + 1] : c.foot.front() + n;
        double sum = 0;
        for (std::size_t i = from; i < to; ++i) {
            sum += weight[i % n];
        }
        const double wanted = std::pow(std::max(c.error[k], kLeastError * c.worst), 0.25);
        for (std::size_t i = from; i < to; ++i) {
            weight[i % n] = sum > 0 ? weight[i % n] * wanted / sum : wanted / static_cast<double>(to - from);
        }
    }
}

/// So many feet that even out the error as well as some rounds of learning get it.
Chosen even_error(const SmoothLine& line, std::size_t count, const PlaceOptions& o) {
    constexpr int kLessons = 6;
    Chosen best;
    best.worst = std::numeric_limits<double>::infinity();
    for (const double shift : {0.0, 0.5}) {
        std::vector<double> weight = line.weight;
        for (int lesson = 0; lesson < kLessons; ++lesson) {
            std::vector<std::size_t> foot =
                spaced(line, by_share(line, shares(line, weight, line.closed ? count : count - 1, o), shift), o);
            if (foot.size() < (line.closed ? 4 : 2)) {
                break;
            }
            Chosen tried = held_against(line, std::move(foot));
            learn(tried, weight);
            if (tried.worst < best.worst) {
                best = std::move(tried);
            }
        }
        if (!line.closed || holds(line, best, o)) {
            break;  // an open line begins with a node
        }
    }
    if (best.foot.empty()) {  // the least spacing takes too many of them away, but never of equal ones
        return held_against(line, by_share(line, equal_shares(line, count), 0));
    }
    return best;
}

/// Feet more, in the middle of every interval that does not hold, until all do or the least spacing forbids it.
Chosen filled(const SmoothLine& line, Chosen c, const PlaceOptions& o) {
    for (bool more = true; more;) {
        more = false;
        std::vector<std::size_t> foot = c.foot;
        for (std::size_t k = 0; k < c.error.size(); ++k) {
            const std::size_t next = k + 1 < c.foot.size() ? c.foot[k + 1] : c.foot.front() + line.s.size();
            const std::size_t half = (c.foot[k] + next) / 2;
            const double before = station_of(line, half) - line.s[c.foot[k]];
            const double behind = length_of(line, c, k) - before;
            if (!holds(line, c, k, o) && divisible(line, c, k) && std::min(before, behind) >= o.min_spacing_mm) {
                foot.push_back(half % line.s.size());
                more = true;
            }
        }
        if (more) {
            std::sort(foot.begin(), foot.end());
            c = held_against(line, std::move(foot));
        }
    }
    return c;
}

/// Without the feet that can go, those first whose intervals have the least error.
Chosen thinned(const SmoothLine& line, Chosen c, const PlaceOptions& o) {
    std::vector<std::pair<double, std::size_t>> order;
    const std::size_t ends = line.closed ? 0 : 1;
    for (std::size_t k = ends; k + ends < c.foot.size(); ++k) {
        order.emplace_back(c.error[k] + c.error[k > 0 ? k - 1 : c.error.size() - 1], c.foot[k]);
    }
    std::sort(order.begin(), order.end());
    for (const auto& [error, gone] : order) {
        if (c.foot.size() <= fewest_feet(line, o)) {
            break;
        }
        std::vector<std::size_t> foot = c.foot;
        std::erase(foot, gone);
        Chosen fewer = held_against(line, std::move(foot));
        if (holds(line, fewer, o)) {
            c = std::move(fewer);
        }
    }
    return c;
}

}  // namespace

Chosen nodes_by_error(const SmoothLine& line, const PlaceOptions& o) {
    const std::size_t fewest = fewest_feet(line, o);
    std::size_t count = fewest;
    Chosen best = even_error(line, count, o);
    while (!holds(line, best, o)) {
        // The error falls with the fourth power of the number.
        const double wanted = static_cast<double>(count) * std::pow(best.worst / o.spline_tolerance_mm, 0.25);
        count = std::max(count + 1, static_cast<std::size_t>(std::min(wanted, 2.0 * static_cast<double>(count))));
        if (2 * count > line.s.size() || count > most_feet(line, o)) {
            return thinned(line, filled(line, std::move(best), o), o);
        }
        best = even_error(line, count, o);
    }
    for (int failed = 0; failed < 2 && count > fewest;) {
        Chosen fewer = even_error(line, --count, o);
        if (holds(line, fewer, o)) {
            best = std::move(fewer);
            failed = 0;
        } else {
            ++failed;
        }
    }
    return thinned(line, std::move(best), o);
}

Chosen nodes_at_equal_steps(const SmoothLine& line, const PlaceOptions& o) {
    const std::size_t most = most_feet(line, o);
    for (std::size_t count = fewest_feet(line, o);; ++count) {
        Chosen chosen = held_against(line, spaced(line, by_share(line, equal_shares(line, count), 0), o));
        if (holds(line, chosen, o) || count >= most) {
            return chosen;
        }
    }
}

}  // namespace seampath
