#include "stages/geometry/density_edge.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "stages/geometry/robust.hpp"

namespace seampath {
namespace {

// lambda_0 over lambda: strays alone, or another face beyond the end that is seen at a glance
constexpr std::array kStrays{0.02, 0.06, 0.12, 0.2};
constexpr double kFallen = 0.3;          // share of the density before it below which a bin lies beyond the end
constexpr std::size_t kBefore = 4;       // bins that tell the density before a place
constexpr std::size_t kBlurred = 2;      // bins right before it that may be the end's own
constexpr std::size_t kAfter = 5;        // bins that tell whether it has ended there,
constexpr std::size_t kFewestAfter = 3;  // or fewer, where another face begins again soon
constexpr double kSure = 14;             // deviance of those
constexpr double kFewest = 12;           // points in those
constexpr double kOverdispersion = 2;    // variance of counts over Poisson's: scanners sample in rows, and lose spots

double phi(double z) {
    return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

// Integral of Phi((e - x) / b) over x from low to high.
double mass(double e, double b, double low, double high) {
    const auto primitive = [](double z) {
        return z * phi(z) + std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
    };
    return b * (primitive((e - low) / b) - primitive((e - high) / b));
}

// How sure it is that n points are too few for a place where e are expected: half of twice the logarithm of the
// likelihood ratio, since counts scatter twice as much as Poisson's.
double deviance(double n, double e) {
    return n < e ? 2 * (e - n + (n > 0 ? n * std::log(n / e) : 0)) / kOverdispersion : 0;
}

// The first place after `from` where two bins hold hardly any points, and those after them too few for a chance gap;
// empty when there are too few before it.
std::optional<double> first_fall(std::span<const double> sorted, double from, double bin) {
    constexpr double kStep = 0.25;  // bins: a gap may begin within one
    const auto count = [&](double low, std::size_t bins) {
        return static_cast<double>(
            std::lower_bound(sorted.begin(), sorted.end(), low + static_cast<double>(bins) * bin) -
            std::lower_bound(sorted.begin(), sorted.end(), low));
    };
    for (double low = from; low < sorted.back() + bin; low += kStep * bin) {
        const double before = count(low - static_cast<double>(kBefore + kBlurred) * bin, kBefore),
                     usual = before / static_cast<double>(kBefore);
        double surest = 0;
        for (std::size_t bins = kFewestAfter; bins <= kAfter; ++bins) {
            surest = std::max(surest, deviance(count(low, bins), static_cast<double>(bins) * usual));
        }
        if (count(low, 2) <= 2 * kFallen * usual && surest > kSure) {
            return before < kFewest ? std::nullopt : std::optional(low);
        }
    }
    return std::nullopt;
}

// The points within [low, high], counted in steps much finer than any end is sharp; an end may lie at any step.
struct Counts {
    double low, high, step;
    std::size_t steps;
    std::vector<std::pair<std::size_t, double>> held;  // steps that hold points, and how many
    double all = 0;

    Counts(std::span<const double> sorted, double from, double to, double width)
        : low(from), high(to), step(width), steps(static_cast<std::size_t>(std::ceil((to - from) / width)) + 1) {
        for (auto x = std::lower_bound(sorted.begin(), sorted.end(), low); x != sorted.end() && *x <= high; ++x) {
            const auto at = static_cast<std::size_t>((*x - low) / step);
            if (held.empty() || held.back().first != at) {
                held.emplace_back(at, 0);
            }
            held.back().second += 1;
            all += 1;
        }
    }
};

// What an end of one blur makes of the counts.
struct Blurred {
    double b;
    std::vector<double> share;  // Phi of a point (k - steps + 1/2) steps before the end
    std::vector<double> seen;   // integral of Phi over the window, for each end

    Blurred(const Counts& counts, double blur) : b(blur) {
        for (std::size_t k = 0; k < 2 * counts.steps; ++k) {
            share.push_back(phi((static_cast<double>(k) - static_cast<double>(counts.steps) - 0.5) * counts.step / b));
        }
        for (std::size_t j = 0; j < counts.steps; ++j) {
            seen.push_back(mass(counts.low + static_cast<double>(j) * counts.step, b, counts.low, counts.high));
        }
    }

    double lambda(const Counts& counts, std::size_t end, double stray) const {
        return counts.all / (seen[end] + stray * (counts.high - counts.low));
    }

    /// Logarithms of the likelihood of each end, lambda being the likeliest, without what does not hang on e and b.
    std::vector<double> log_likelihoods(const Counts& counts, double stray) const {
        std::vector<double> of_distance;
        for (const double x : share) {
            of_distance.push_back(std::log(x + stray));
        }
        std::vector<double> result;
        for (std::size_t j = 0; j < counts.steps; ++j) {
            double sum = counts.all * std::log(lambda(counts, j, stray));
            for (const auto& [i, n] : counts.held) {
                sum += n * of_distance[counts.steps + j - i];
            }
            result.push_back(sum);
        }
        return result;
    }
};

// Mean and variance over all ends, blurs and strays, each as likely beforehand as the other.
DensityEdge posterior(const Counts& counts, double noise) {
    struct Member {
        const Blurred& blurred;
        double stray;
        std::vector<double> likelihood;
    };
    std::vector<Blurred> blurs;
    for (const double blur : {0.5, 1.0, 2.0, 4.0, 7.0}) {
        blurs.emplace_back(counts, blur * noise);
    }
    std::vector<Member> members;
    double best = -std::numeric_limits<double>::infinity();
    for (const Blurred& blurred : blurs) {
        for (const double stray : kStrays) {
            members.push_back({blurred, stray, blurred.log_likelihoods(counts, stray)});
            const auto& all = members.back().likelihood;
            best = std::max(best, *std::max_element(all.begin(), all.end()));
        }
    }
    double weights = 0, squares = 0;
    DensityEdge edge;
    for (const Member& m : members) {
        for (std::size_t j = 0; j < m.likelihood.size(); ++j) {
            const double weight = std::exp((m.likelihood[j] - best) / kOverdispersion);
            const double e = static_cast<double>(j) * counts.step;
            weights += weight;
            edge.at += weight * e;
            squares += weight * e * e;
            edge.blur += weight * m.blurred.b;
            edge.density += weight * m.blurred.lambda(counts, j, m.stray);
        }
    }
    const double mean = edge.at / weights;
    edge.at = counts.low + mean;
    edge.blur /= weights;
    edge.density /= weights;
    // No better than one point's distance.
    edge.sigma = std::sqrt(squares / weights - mean * mean + kOverdispersion / (edge.density * edge.density));
    return edge;
}

}  // namespace

std::optional<DensityEdge> density_edge(std::vector<double> x, double from, double bin, double noise) {
    std::sort(x.begin(), x.end());
    if (x.empty()) {
        return std::nullopt;
    }
    // Bins as fine as hold enough points to tell them from none.
    constexpr double kEnough = 8;
    const auto before = std::lower_bound(x.begin(), x.end(), from) -
                        std::lower_bound(x.begin(), x.end(), from - static_cast<double>(kBefore) * bin);
    bin = std::clamp(kEnough * static_cast<double>(kBefore) * bin / std::max(1.0, static_cast<double>(before)), bin,
                     3 * bin);
    const auto fall = first_fall(x, from, bin);
    if (!fall) {
        return std::nullopt;
    }
    const double low = *fall - static_cast<double>(kBefore) * bin, high = *fall + 2 * bin;
    const Counts counts(x, low, high, 0.3 * std::min(noise, 0.5 * bin));
    DensityEdge edge = posterior(counts, noise);
    edge.sigma = std::hypot(edge.sigma, std::sqrt(std::max(0.0, edge.blur * edge.blur - 4 * noise * noise)));
    return edge;
}

}  // namespace seampath
