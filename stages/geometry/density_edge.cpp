#include "stages/geometry/density_edge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "stages/geometry/robust.hpp"

namespace seampath {
namespace {

constexpr double kStray = 0.02;        // lambda_0 over lambda
constexpr double kFallen = 0.15;       // share of the density before it below which a bin lies beyond the end
constexpr std::size_t kBefore = 4;     // bins that tell the density before a place
constexpr double kFewest = 12;         // points in those
constexpr double kOverdispersion = 2;  // variance of counts over Poisson's: scanners sample in rows, and lose spots

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

// The first place after `from` where two bins in a row hold hardly any points; empty when there are too few before it.
std::optional<double> first_fall(std::span<const double> sorted, double from, double bin) {
    const auto count = [&](double low) {
        return static_cast<double>(std::lower_bound(sorted.begin(), sorted.end(), low + bin) -
                                   std::lower_bound(sorted.begin(), sorted.end(), low));
    };
    std::vector<double> before;
    for (std::size_t i = kBefore; i > 0; --i) {
        before.push_back(count(from - bin * static_cast<double>(i)));
    }
    for (double low = from; low < sorted.back() + bin; low += bin) {
        std::vector<double> recent(before.end() - kBefore, before.end());
        double all = 0;
        for (const double n : recent) {
            all += n;
        }
        const double usual = quantile(recent, 0.5), here = count(low);
        if (here <= kFallen * usual && count(low + bin) <= kFallen * usual) {
            return all < kFewest ? std::nullopt : std::optional(low);
        }
        before.push_back(here);
    }
    return std::nullopt;
}

// The points within [low, high], counted in steps much finer than any end is sharp, and how likely an end at one of the
// steps makes them.
struct Counts {
    double low, high, step;
    std::vector<double> count;
    double all = 0;

    Counts(std::span<const double> sorted, double from, double to, double width)
        : low(from), high(to), step(width), count(static_cast<std::size_t>(std::ceil((to - from) / width)) + 1, 0) {
        for (auto x = std::lower_bound(sorted.begin(), sorted.end(), low); x != sorted.end() && *x <= high; ++x) {
            count[static_cast<std::size_t>((*x - low) / step)] += 1;
            all += 1;
        }
    }
    double lambda(double e, double b) const { return all / (mass(e, b, low, high) + kStray * (high - low)); }

    /// Logarithms of the likelihood of ends at low + j step, j = 0, 1, ..., lambda being the likeliest, without what
    /// does not hang on e and b.
    std::vector<double> log_likelihoods(double b) const {
        const std::size_t n = count.size();
        std::vector<double> of_distance(2 * n);  // of a point (k - n + 1/2) steps before the end
        for (std::size_t k = 0; k < 2 * n; ++k) {
            of_distance[k] = std::log(phi((static_cast<double>(k) - static_cast<double>(n) - 0.5) * step / b) + kStray);
        }
        std::vector<double> result(n);
        for (std::size_t j = 0; j < n; ++j) {
            double sum = all * std::log(lambda(low + static_cast<double>(j) * step, b));
            for (std::size_t i = 0; i < n; ++i) {
                sum += count[i] * of_distance[n + j - i];
            }
            result[j] = sum;
        }
        return result;
    }
};

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
                     2 * bin);
    const auto fall = first_fall(x, from, bin);
    if (!fall) {
        return std::nullopt;
    }
    const double low = *fall - static_cast<double>(kBefore) * bin, high = *fall + 2 * bin;
    const Counts counts(x, low, high, 0.2 * std::min(noise, 0.5 * bin));
    DensityEdge edge;
    double best = -std::numeric_limits<double>::infinity();
    for (const double blur : {0.5, 1.0, 2.0, 4.0, 7.0}) {
        const auto likelihood = counts.log_likelihoods(blur * noise);
        const auto top = std::max_element(likelihood.begin(), likelihood.end());
        if (*top > best) {
            best = *top;
            edge.at = low + static_cast<double>(top - likelihood.begin()) * counts.step;
            edge.blur = blur * noise;
        }
    }
    edge.density = counts.lambda(edge.at, edge.blur);
    // The information on e is lambda / b times the integral of phi^2 / Phi, 0.903; of a sharp end one point's distance.
    const double information = edge.blur / (0.903 * edge.density) + 1 / (edge.density * edge.density);
    const double soft = std::max(0.0, edge.blur * edge.blur - 4 * noise * noise);
    edge.sigma = std::sqrt(kOverdispersion * information + soft);
    return edge;
}

}  // namespace seampath
