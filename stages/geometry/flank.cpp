#include "stages/geometry/flank.hpp"

#include <array>
#include <cmath>
#include <limits>

namespace seampath {
namespace {

constexpr double kShrink = 0.7;
constexpr double kGrow = 1.5;
constexpr double kMostTaken = 0.85;   // share of a window's points that a fit must explain to be taken at once
constexpr double kRough = 1.6;        // residual scale, in noises, beyond which no one surface is what was fitted
constexpr double kPointsAcross = 12;  // of the smallest window, in point distances
constexpr double kNoiseWidths = 15;   // of the smallest window, in noises: its slope is then known to a few degrees
constexpr double kBandWidths = 4;
constexpr double kLeastNoise = 0.02;  // what counts as noise where a scan has none, in point distances
constexpr int kBins = 5;
constexpr std::size_t kLeastPoints = 24;
constexpr std::size_t kEnoughPoints =
    12000;  // a flank's: more add time and, their noise being shared, nothing to the fit

// Largest mean residual over bins across one variable, in units of what noise allows.
double misfit(const QuadraticFit& fit, double low, double high, bool over_u, double noise, double correlation) {
    std::array<double, kBins> sum{}, weight{};
    for (std::size_t i = 0; i < fit.size(); ++i) {
        const double x = ((over_u ? fit.u(i) : fit.s(i)) - low) / (high - low);
        const auto bin = static_cast<std::size_t>(std::clamp(static_cast<int>(x * kBins), 0, kBins - 1));
        sum[bin] += fit.weight(i) * fit.residual(i);
        weight[bin] += fit.weight(i);
    }
    double worst = 0;
    for (std::size_t bin = 0; bin < kBins; ++bin) {
        if (weight[bin] >= 6) {
            const double allowed = std::max(0.3 * noise, 3 * noise * std::sqrt(correlation / weight[bin]));
            worst = std::max(worst, std::abs(sum[bin] / weight[bin]) / allowed);
        }
    }
    return worst;
}

// Some hundred and fifty points, and a slope known to a few degrees.
SectionWindow smallest_window(const ScanScale& scale) {
    const double away = std::max(kPointsAcross * scale.spacing, kNoiseWidths * scale.noise);
    return {0.7 * away, away, std::max(kBandWidths * scale.spacing, kBandWidths * scale.noise)};
}

// Fits the samples of one window. `inner`, when given, is the fit of a smaller window: what lies off its continuation
// is left out.
std::optional<QuadraticFit> fit_window(const FlankPoints& samples, const SectionWindow& w, double noise,
                                       const Flank* inner) {
    QuadraticFit fit;
    fit.begin(samples.points.size(), w.away, w.along);
    for (const FlankPoint& x : samples.points) {
        if (x.u > w.away || std::abs(x.s) > w.along) {
            continue;
        }
        if (inner && std::abs(residual(*inner, x.u, x.s, x.z)) > gate(*inner, x.u, x.s)) {
            continue;
        }
        fit.add(x.u / w.away, x.s / w.along, x.z);
    }
    if (fit.size() < kLeastPoints || !fit.solve(0.3 * noise)) {
        return std::nullopt;
    }
    return fit;
}

struct Quality {
    double across = 0, along = 0;  // worst misfit over bins, 1 is what noise allows
    bool rough = false;
    bool good() const { return across <= 1 && along <= 1 && !rough; }
};

Quality quality_of(const QuadraticFit& fit, const SectionWindow& w, double noise, double correlation) {
    return {misfit(fit, w.band / w.away, 1, true, noise, correlation), misfit(fit, -1, 1, false, noise, correlation),
            fit.scale() > kRough * noise};
}

// Smallest window that carries a fit; the surface may be too bent even for the one it begins with.
std::optional<Flank> begin_flank(const FlankPoints& samples, const ScanScale& scale, double noise,
                                 const SectionWindow& limit) {
    Flank flank;
    flank.noise = noise;
    const SectionWindow start = smallest_window(scale);
    flank.window = {std::min(limit.along, start.along), std::min(limit.away, start.away), limit.band};
    auto fit = fit_window(samples, flank.window, noise, nullptr);
    while (!fit && flank.window.away < limit.away) {
        flank.window.away = std::min(limit.away, flank.window.away / kShrink);
        flank.window.along = std::min(limit.along, flank.window.along / kShrink);
        fit = fit_window(samples, flank.window, noise, nullptr);
    }
    if (!fit) {
        return std::nullopt;
    }
    flank.fit = std::move(*fit);
    flank.share = samples.share;
    for (int shrinks = 0; shrinks < 4; ++shrinks) {
        const Quality q = quality_of(flank.fit, flank.window, noise, scale.correlation);
        if (q.good()) {
            break;
        }
        SectionWindow w = flank.window;
        (q.along > q.across ? w.along : w.away) *= kShrink;
        fit = w.away > w.band + 3 * scale.spacing && w.along > 2 * scale.spacing
                  ? fit_window(samples, w, noise, nullptr)
                  : std::nullopt;
        if (!fit) {
            break;
        }
        flank.window = w;
        flank.fit = std::move(*fit);
    }
    return flank;
}

// How far a surface of curvature k is known by its curvature alone: the term of a circle after the one that the fit
// takes off, k^5 x^6 / 16, is to stay below a third of the noise.
double curvature_reach(double k, double noise) {
    return k > 0 ? std::pow(16 * 0.3 * noise / std::pow(k, 5), 1.0 / 6) : std::numeric_limits<double>::infinity();
}

// The limit cut down to where the flank's curvature, as far as the fit is sure of it, lets the fit be carried on. Twist
// bends both ways: a row of the curvature matrix bounds the bend in its direction.
SectionWindow within_reach(const Flank& flank, const SectionWindow& limit, double noise, double correlation) {
    const QuadraticFit::Normal cofactors = flank.fit.cofactors();
    const double unit = flank.fit.scale() * std::sqrt(correlation);
    const SectionWindow& w = flank.window;
    const auto sure = [&](int i) {
        return std::max(0.0, std::abs(flank.fit.coefficients()[i]) - 2 * unit * std::sqrt(cofactors(i, i)));
    };
    const double across = 2 * sure(3) / (w.away * w.away), twist = sure(4) / (w.away * w.along),
                 along = 2 * sure(5) / (w.along * w.along);
    return {std::min(limit.along, curvature_reach(along + twist, noise)),
            std::min(limit.away, curvature_reach(across + twist, noise)), limit.band};
}

// Noise of this very surface, which may be seen at more of a slant than the place as a whole: scatter of the points
// about the means of small bins, so that a bend does not pass for noise.
double flank_noise(const FlankPoints& samples, const ScanScale& scale, const SectionWindow& limit) {
    constexpr std::size_t kAcross = 4;
    constexpr double kMost = 2.5;  // of the place's noise; what is rougher is another surface, or none
    const double least = noise_of(scale);
    const SectionWindow start = smallest_window(scale);
    const SectionWindow w{std::min(limit.along, start.along), std::min(limit.away, start.away), limit.band};
    const auto fit = fit_window(samples, w, least, nullptr);
    if (!fit) {
        return least;
    }
    std::array<double, kAcross * kAcross> sum{}, count{};
    const auto bin = [&](std::size_t i) {
        const double u = (fit->u(i) * w.away - w.band) / (w.away - w.band), s = (fit->s(i) + 1) / 2;
        const auto step = [](double x) {
            return std::min(kAcross - 1, static_cast<std::size_t>(std::max(0.0, x) * kAcross));
        };
        return step(u) * kAcross + step(s);
    };
    for (std::size_t i = 0; i < fit->size(); ++i) {
        if (fit->weight(i) > 0) {
            sum[bin(i)] += fit->residual(i);
            count[bin(i)] += 1;
        }
    }
    std::vector<double> scatter;
    for (std::size_t i = 0; i < fit->size(); ++i) {
        const double n = count[bin(i)];
        if (fit->weight(i) > 0 && n > 1) {
            scatter.push_back(std::abs(fit->residual(i) - sum[bin(i)] / n) * std::sqrt(n / (n - 1)));
        }
    }
    return std::clamp(1.4826 * quantile(scatter, 0.5), least, kMost * least);
}

// Whether what a wider window holds beyond the flank's own is the same surface going on, and not strays or what lies
// behind its edge: a share of the flank's density at least.
bool goes_on(const Flank& flank, const QuadraticFit& fit, const SectionWindow& w) {
    constexpr double kLeastDensity = 0.3;
    const auto area = [](const SectionWindow& x) { return 2 * x.along * (x.away - x.band); };
    const auto inside = static_cast<double>(flank.fit.size()), all = static_cast<double>(fit.size());
    return all - inside >= kLeastDensity * inside / area(flank.window) * (area(w) - area(flank.window));
}

// Takes the whole of the limit, as far as the flank's curvature is known, when one surface explains it.
bool take_whole(Flank& flank, const FlankPoints& samples, const ScanScale& scale, const SectionWindow& limit,
                bool continued) {
    auto fit = fit_window(samples, limit, flank.noise, continued ? &flank : nullptr);
    if (!fit || fit->share_taken() < kMostTaken || !quality_of(*fit, limit, flank.noise, scale.correlation).good() ||
        (continued && !goes_on(flank, *fit, limit))) {
        return false;
    }
    flank.window = limit;
    flank.fit = std::move(*fit);
    flank.share = samples.share;
    return true;
}

// The window grows, across and along in turn, as long as one surface explains what it holds: where it ends, the surface
// ends or turns.
void grow(Flank& flank, const FlankPoints& samples, const ScanScale& scale, const SectionWindow& limit) {
    const double noise = flank.noise;
    bool across = true, along = true;
    while ((across && flank.window.away < limit.away) || (along && flank.window.along < limit.along)) {
        for (const bool widen_across : {true, false}) {
            bool& open = widen_across ? across : along;
            double SectionWindow::*const extent = widen_across ? &SectionWindow::away : &SectionWindow::along;
            if (!open || flank.window.*extent >= limit.*extent) {
                continue;
            }
            SectionWindow w = flank.window;
            w.*extent = std::min(
                {limit.*extent, w.*extent * kGrow, within_reach(flank, limit, noise, scale.correlation).*extent});
            if (w.*extent < 1.1 * flank.window.*extent) {
                open = false;
                continue;
            }
            auto fit = fit_window(samples, w, noise, &flank);
            if (fit && quality_of(*fit, w, noise, scale.correlation).good() && goes_on(flank, *fit, w)) {
                flank.window = w;
                flank.fit = std::move(*fit);
                flank.share = samples.share;
            } else {
                open = false;
            }
        }
    }
}

// Variance of the means of blocks of residuals over that of as many independent ones. Blocks are much wider than noise
// is correlated; what they share is also whatever bends the surface by less than the tests of its shape see.
double shared_variance(const QuadraticFit& fit) {
    constexpr std::size_t kAcross = 6, kAlong = 8;
    std::array<double, kAcross * kAlong> sum{};
    double squares = 0;
    for (std::size_t i = 0; i < fit.size(); ++i) {
        const auto at = [](double x, std::size_t n) {
            return static_cast<std::size_t>(std::clamp(x * static_cast<double>(n), 0.0, static_cast<double>(n) - 0.5));
        };
        const double r = fit.weight(i) * fit.residual(i);
        sum[at(fit.u(i), kAcross) * kAlong + at((fit.s(i) + 1) / 2, kAlong)] += r;
        squares += r * r;
    }
    double shared = 0, blocks = 0;
    for (const double x : sum) {
        shared += x * x;
        blocks += x != 0;
    }
    // Six parameters have been fitted to the sums.
    return blocks > 12 && squares > 0 ? shared / squares * blocks / (blocks - 6) : 1;
}

// 1-sigma of one point as far as means over many go. Thinned by lot, noise that neighbours shared is less of a share of
// what is left.
double unit_of_means(const Flank& flank, const ScanScale& scale) {
    return flank.fit.scale() *
           std::sqrt(std::max(1 + flank.share * (scale.correlation - 1), shared_variance(flank.fit)));
}

// Where points at these distances from the seam, or from the section, end: infinity when they go on to the last one
// possible.
double end_of(const std::vector<double>& distance, double from, double to, double spacing) {
    constexpr double kLeastShare = 0.25;  // of the usual density; two bins without it are no hole
    const double bin = 3 * spacing;
    std::vector<double> count(static_cast<std::size_t>(std::max(0.0, (to - from) / bin)) + 1, 0), nearer;
    for (const double x : distance) {
        count[std::min(count.size() - 1, static_cast<std::size_t>(std::max(0.0, (x - from) / bin)))] += 1;
    }
    for (std::size_t i = 1; i + 2 < count.size(); ++i) {  // the last bin is a part of one
        nearer.assign(count.begin(), count.begin() + static_cast<std::ptrdiff_t>(i));
        const double enough = kLeastShare * quantile(nearer, 0.5);
        if (count[i] < enough && count[i + 1] < enough) {
            return from + bin * static_cast<double>(i);
        }
    }
    return std::numeric_limits<double>::infinity();
}

// How far from the seam a flank may be used where it ends within the window. What lies at its edge is a face that turns
// away, seen from beside: it would bend the fit. Edges have radii as corners have: a band is left out there too.
double edge_across(const FlankPoints& samples, const ScanScale& scale, const SectionWindow& w) {
    std::vector<double> u;
    for (const FlankPoint& x : samples.points) {
        u.push_back(x.u);
    }
    return std::max(end_of(u, w.band, w.away, scale.spacing) - w.band, w.band + 6 * scale.spacing);
}

// The same along the seam, each way; the samples beyond are left out.
FlankPoints within_ends(const FlankPoints& samples, const ScanScale& scale, const SectionWindow& w) {
    FlankPoints kept;
    kept.share = samples.share;
    double reach[2] = {};
    for (const int way : {0, 1}) {
        std::vector<double> s;
        for (const FlankPoint& x : samples.points) {
            if ((x.s < 0) == (way == 0)) {
                s.push_back(std::abs(x.s));
            }
        }
        reach[way] = std::max(end_of(s, 0, w.along, scale.spacing) - w.band, 3 * scale.spacing);
    }
    std::copy_if(samples.points.begin(), samples.points.end(), std::back_inserter(kept.points),
                 [&](const FlankPoint& x) { return x.s >= -reach[0] && x.s <= reach[1]; });
    return kept;
}

}  // namespace

SectionWindow following_window(const ScanScale& scale) {
    const SectionWindow least = smallest_window(scale);
    const double wider = std::clamp(std::sqrt(scale.correlation), 2.2, 3.0);
    return {wider * least.along, wider * least.away, least.band};
}

SectionWindow measuring_window(const ScanScale& scale) {
    const SectionWindow follow = following_window(scale);
    return {3.3 * follow.along, 2.4 * follow.away, follow.band};
}

void thin_out(FlankPoints& samples) {
    samples.share = std::min(
        1.0, static_cast<double>(kEnoughPoints) / static_cast<double>(std::max<std::size_t>(1, samples.points.size())));
    if (samples.share < 1) {
        const auto limit = static_cast<std::uint32_t>(samples.share * 4294967295.0);
        std::erase_if(samples.points, [limit](const FlankPoint& x) { return x.lot > limit; });
    }
}

double noise_of(const ScanScale& scale) {
    return std::max(scale.noise, kLeastNoise * scale.spacing);
}

std::optional<Flank> fit_flank(const FlankPoints& samples, const ScanScale& scale, SectionWindow limit) {
    Flank flank;
    flank.edge = edge_across(samples, scale, limit);
    limit.away = std::min(limit.away, flank.edge);
    flank.noise = flank_noise(samples, scale, limit);
    if (take_whole(flank, samples, scale, limit, false)) {
        const SectionWindow reach = within_reach(flank, limit, flank.noise, scale.correlation);
        if (reach.away >= 0.9 * limit.away && reach.along >= 0.9 * limit.along) {
            return flank;
        }
    }
    const FlankPoints inside = within_ends(samples, scale, limit);
    auto begun = begin_flank(inside, scale, flank.noise, limit);
    if (begun) {
        begun->edge = flank.edge;
        grow(*begun, inside, scale, limit);
    }
    return begun;
}

void widen(Flank& flank, const FlankPoints& samples, const ScanScale& scale, SectionWindow limit) {
    limit.away = std::min(limit.away, flank.edge);
    SectionWindow reach = within_reach(flank, limit, flank.noise, scale.correlation);
    reach.away = std::max(reach.away, flank.window.away);
    reach.along = std::max(reach.along, flank.window.along);
    if (!take_whole(flank, samples, scale, reach, true)) {
        grow(flank, samples, scale, limit);
    }
}

void settle_flank(Flank& flank, const ScanScale& scale) {
    flank.unit = unit_of_means(flank, scale);
    flank.fit.shrink(flank.unit);
}

void finish_flank(Flank& flank, const ScanScale& scale, double u) {
    const SectionWindow& w = flank.window;
    const auto& c = flank.fit.coefficients();
    const double x = u / w.away;
    flank.height = flank.fit.value(x, 0);
    flank.slope = (c[1] + 2 * c[3] * x) / w.away;
    flank.slope_along = (c[2] + c[4] * x) / w.along;
    const auto row = QuadraticFit::row(x, 0);
    flank.sigma = std::sqrt(row.dot(flank.fit.cofactors() * row)) * flank.unit;
    const double slab = std::max(2.5 * scale.spacing, w.along / 8) / w.along;
    double count = 0;
    for (std::size_t i = 0; i < flank.fit.size(); ++i) {
        count += std::abs(flank.fit.s(i)) <= slab && flank.fit.weight(i) > 0;
    }
    flank.slab_points = count / flank.share / (2 * slab * w.along) / (w.away - w.band);
}

}  // namespace seampath
