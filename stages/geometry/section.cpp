#include "stages/geometry/section.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Dense>

#include "stages/geometry/lot.hpp"

namespace seampath {
namespace {

constexpr double kGateSlope = 20 * std::numbers::pi / 180;
constexpr double kShrink = 0.7;
constexpr double kGrow = 1.5;
constexpr double kContinuation = 0.15;        // slope by which a surface may leave the continuation of its inner part
constexpr double kMostTaken = 0.85;           // share of a window's points that a fit must explain to be taken at once
constexpr double kRough = 1.6;                // residual scale, in noises, beyond which the surface is not quadratic
constexpr double kPointsAcross = 12;          // of the smallest window, in point distances
constexpr double kNoiseWidths = 15;           // of the smallest window, in noises: its slope is then known to a few degrees
constexpr double kBandWidths = 4;
constexpr double kLeastNoise = 0.02;          // what counts as noise where a scan has none, in point distances
constexpr int kBins = 5;
constexpr std::size_t kLeastPoints = 24;

double noise_of(const ScanScale& scale) { return std::max(scale.noise, kLeastNoise * scale.spacing); }

struct Sample {
    float u, s, z;
    std::uint32_t lot;      // the same for the same point, in whatever order the points came
};

// More points than this to a flank add time and, their noise being shared, nothing to the fit: lots are drawn.
constexpr std::size_t kEnoughPoints = 12000;

struct Samples {
    std::vector<Sample> points;
    double share = 1;       // of the scan's points there
};

// Keeps a share of the samples, chosen by lot.
void thin_out(Samples& samples) {
    samples.share = std::min(1.0, static_cast<double>(kEnoughPoints) / static_cast<double>(std::max<std::size_t>(1, samples.points.size())));
    if (samples.share < 1) {
        const auto limit = static_cast<std::uint32_t>(samples.share * 4294967295.0);
        std::erase_if(samples.points, [limit](const Sample& x) { return x.lot > limit; });
    }
}

struct Frame {
    Eigen::Vector3d p, t, n[2], d[2];
};

std::optional<Frame> frame_of(const Section& section) {
    Frame f;
    f.p = section.p;
    f.n[0] = section.n1;
    f.n[1] = section.n2;
    const Eigen::Vector3d axis = section.n1.cross(section.n2);
    if (axis.norm() < 1e-3) {
        return std::nullopt;
    }
    f.t = axis.normalized();
    f.d[0] = f.t.cross(section.n1);
    f.d[1] = section.n2.cross(f.t);
    return f;
}

// What two fits within a small window tell of the flanks.
using FirstLook = std::array<Flank, 2>;

double residual(const Flank& flank, double u, double s, double z) {
    return flank.fit.residual(u / flank.window.away, s / flank.window.along, z);
}

// How far the truth may lie off a fit that is carried on to (u, s), beyond its window, mm.
double continuation_doubt(const Flank& flank, double u, double s) {
    return kContinuation * std::max({0.0, u - flank.window.away, std::abs(s) - flank.window.along});
}

// Points further off a fit than this belong to something else, a step, an edge, another wall.
double gate(const Flank& flank, double u, double s) { return 4 * flank.noise + continuation_doubt(flank, u, s); }

// Points of both flanks within the window and no closer to the seam than its band. Without a first look at the flanks the
// gate is a wedge: it opens with the distance from the seam, so that a guess a few degrees off still sees its flank, but
// never reaches the other flank. After it each flank is carried on, and ends where it comes near to the other: the seam may
// bend within the window.
std::array<Samples, 2> gather(const PointGrid& grid, const ScanScale& scale, const Frame& f, const SectionWindow& w, const FirstLook* look) {
    std::array<Samples, 2> samples;
    const double sine = f.n[0].cross(f.n[1]).norm(), opening = std::numbers::pi - std::atan2(sine, f.n[0].dot(f.n[1]));
    const double slope = std::tan(std::min(0.3 * opening, kGateSlope)), base = 4 * scale.noise + scale.spacing;
    const double nearest = look ? -w.away : w.band;
    const auto wanted = [&](std::size_t k, const Eigen::Vector3d& v, double u, double s, double z) {
        if (!look) {
            return std::abs(z) <= base + slope * u;
        }
        const double off = residual((*look)[k], u, s, z);
        if (std::abs(off) > gate((*look)[k], u, s)) {
            return false;
        }
        const Eigen::Vector3d foot = v - off * f.n[k];
        const std::size_t other = 1 - k;
        const double other_u = foot.dot(f.d[other]);
        return residual((*look)[other], other_u, s, foot.dot(f.n[other])) >=
               std::max(w.band * sine, continuation_doubt((*look)[other], other_u, s));
    };
    // The box of the two flank rectangles.
    Eigen::Vector3d low = f.p, high = f.p;
    for (std::size_t k = 0; k < 2; ++k) {
        for (const double u : {nearest, w.away}) {
            for (const double s : {-w.along, w.along}) {
                for (const double side : {-1.0, 1.0}) {
                    const double z = look ? std::abs(residual((*look)[k], u, s, 0)) + gate((*look)[k], u, s) : base + slope * u;
                    const Eigen::Vector3d corner = f.p + u * f.d[k] + s * f.t + side * z * f.n[k];
                    low = low.cwiseMin(corner);
                    high = high.cwiseMax(corner);
                }
            }
        }
    }
    grid.for_cells_in_box(low, high, [&](std::size_t cell) {
        for (const Eigen::Vector3f& q : grid.points(cell)) {
            const Eigen::Vector3d v = q.cast<double>() - f.p;
            const double s = v.dot(f.t);
            if (std::abs(s) > w.along) {
                continue;
            }
            for (std::size_t k = 0; k < 2; ++k) {
                const double u = v.dot(f.d[k]), z = v.dot(f.n[k]);
                if (u >= nearest && u <= w.away && wanted(k, v, u, s, z)) {
                    samples[k].points.push_back({static_cast<float>(u), static_cast<float>(s), static_cast<float>(z), lot_of(q)});
                }
            }
        }
    });
    thin_out(samples[0]);
    thin_out(samples[1]);
    return samples;
}

// Largest mean residual over bins across one variable, in units of what noise allows, and whether it sits at the low end.
struct Misfit {
    double worst = 0;
    bool at_low_end = false;
};
Misfit misfit(const QuadraticFit& fit, double low, double high, bool over_u, double noise, double correlation) {
    std::array<double, kBins> sum{}, weight{};
    for (std::size_t i = 0; i < fit.size(); ++i) {
        const double x = ((over_u ? fit.u(i) : fit.s(i)) - low) / (high - low);
        const auto bin = static_cast<std::size_t>(std::clamp(static_cast<int>(x * kBins), 0, kBins - 1));
        sum[bin] += fit.weight(i) * fit.residual(i);
        weight[bin] += fit.weight(i);
    }
    Misfit result;
    for (std::size_t bin = 0; bin < kBins; ++bin) {
        if (weight[bin] < 6) {
            continue;
        }
        const double allowed = std::max(0.3 * noise, 3 * noise * std::sqrt(correlation / weight[bin]));
        const double ratio = std::abs(sum[bin] / weight[bin]) / allowed;
        if (ratio > result.worst) {
            result = {ratio, bin == 0};
        }
    }
    return result;
}

// Some hundred and fifty points, and a slope known to a few degrees.
SectionWindow smallest_window(const ScanScale& scale) {
    const double away = std::max(kPointsAcross * scale.spacing, kNoiseWidths * scale.noise);
    return {0.7 * away, away, std::max(kBandWidths * scale.spacing, kBandWidths * scale.noise)};
}

// Fits the samples of one window. `inner`, when given, is the fit of a smaller window: what lies off its continuation is left
// out.
std::optional<QuadraticFit> fit_window(const Samples& samples, const SectionWindow& w, double noise, const Flank* inner) {
    QuadraticFit fit;
    fit.begin(samples.points.size(), w.away, w.along);
    for (const Sample& x : samples.points) {
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
    double across = 0, along = 0;      // worst misfit over bins, 1 is what noise allows
    bool at_band = false;              // the worst across is at the seam's side
    bool rough = false;
    bool good() const { return across <= 1 && along <= 1 && !rough; }
};

Quality quality_of(const QuadraticFit& fit, const SectionWindow& w, double noise, double correlation) {
    const Misfit across = misfit(fit, w.band / w.away, 1, true, noise, correlation), along = misfit(fit, -1, 1, false, noise, correlation);
    return {across.worst, along.worst, across.at_low_end, fit.scale() > kRough * noise};
}

// Smallest window that carries a fit; the surface may be too bent even for the one it begins with.
std::optional<Flank> begin_flank(const Samples& samples, const ScanScale& scale, double noise, const SectionWindow& limit) {
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
        fit = w.away > w.band + 3 * scale.spacing && w.along > 2 * scale.spacing ? fit_window(samples, w, noise, nullptr) : std::nullopt;
        if (!fit) {
            break;
        }
        flank.window = w;
        flank.fit = std::move(*fit);
    }
    return flank;
}

// How far a surface of curvature k is known by its curvature alone: the term of a circle after the one that the fit takes
// off, k^5 x^6 / 16, is to stay below a third of the noise.
double curvature_reach(double k, double noise) {
    return k > 0 ? std::pow(16 * 0.3 * noise / std::pow(k, 5), 1.0 / 6) : std::numeric_limits<double>::infinity();
}

// The limit cut down to where the flank's curvature, as far as the fit is sure of it, lets the fit be carried on. Twist bends
// both ways: a row of the curvature matrix bounds the bend in its direction.
SectionWindow within_reach(const Flank& flank, const SectionWindow& limit, double noise, double correlation) {
    const QuadraticFit::Normal cofactors = flank.fit.cofactors();
    const double unit = flank.fit.scale() * std::sqrt(correlation);
    const SectionWindow& w = flank.window;
    const auto sure = [&](int i) { return std::max(0.0, std::abs(flank.fit.coefficients()[i]) - 2 * unit * std::sqrt(cofactors(i, i))); };
    const double across = 2 * sure(3) / (w.away * w.away), twist = sure(4) / (w.away * w.along), along = 2 * sure(5) / (w.along * w.along);
    return {std::min(limit.along, curvature_reach(along + twist, noise)), std::min(limit.away, curvature_reach(across + twist, noise)), limit.band};
}

// Noise of this very surface, which may be seen at more of a slant than the place as a whole: scatter of the points about the
// means of small bins, so that a bend does not pass for noise.
double flank_noise(const Samples& samples, const ScanScale& scale, const SectionWindow& limit) {
    constexpr std::size_t kAcross = 4;
    constexpr double kMost = 2.5;      // of the place's noise; what is rougher is another surface, or none
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
        const auto step = [](double x) { return std::min(kAcross - 1, static_cast<std::size_t>(std::max(0.0, x) * kAcross)); };
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

// Whether what a wider window holds beyond the flank's own is the same surface going on, and not strays or what lies behind
// its edge: a share of the flank's density at least.
bool goes_on(const Flank& flank, const QuadraticFit& fit, const SectionWindow& w) {
    constexpr double kLeastDensity = 0.3;
    const auto area = [](const SectionWindow& x) { return 2 * x.along * (x.away - x.band); };
    const auto inside = static_cast<double>(flank.fit.size()), all = static_cast<double>(fit.size());
    return all - inside >= kLeastDensity * inside / area(flank.window) * (area(w) - area(flank.window));
}

// Takes the whole of the limit, as far as the flank's curvature is known, when one surface explains it.
bool take_whole(Flank& flank, const Samples& samples, const ScanScale& scale, const SectionWindow& limit, bool continued) {
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

// The window grows, across and along in turn, as long as one surface explains what it holds: where it ends, the surface ends
// or turns.
void grow(Flank& flank, const Samples& samples, const ScanScale& scale, const SectionWindow& limit) {
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
            w.*extent = std::min({limit.*extent, w.*extent * kGrow, within_reach(flank, limit, noise, scale.correlation).*extent});
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

// Where points at these distances from the seam, or from the section, end: infinity when they go on to the last one possible.
double end_of(const std::vector<double>& distance, double from, double to, double spacing) {
    constexpr double kLeastShare = 0.25;      // of the usual density; two bins without it are no hole
    const double bin = 3 * spacing;
    std::vector<double> count(static_cast<std::size_t>(std::max(0.0, (to - from) / bin)) + 1, 0), nearer;
    for (const double x : distance) {
        count[std::min(count.size() - 1, static_cast<std::size_t>(std::max(0.0, (x - from) / bin)))] += 1;
    }
    for (std::size_t i = 1; i + 2 < count.size(); ++i) {      // the last bin is a part of one
        nearer.assign(count.begin(), count.begin() + static_cast<std::ptrdiff_t>(i));
        const double enough = kLeastShare * quantile(nearer, 0.5);
        if (count[i] < enough && count[i + 1] < enough) {
            return from + bin * static_cast<double>(i);
        }
    }
    return std::numeric_limits<double>::infinity();
}

// How far from the seam a flank may be used where it ends within the window. What lies at its edge is a face that turns away,
// seen from beside: it would bend the fit. Edges have radii as corners have: a band is left out there too.
double edge_across(const Samples& samples, const ScanScale& scale, const SectionWindow& w) {
    std::vector<double> u;
    for (const Sample& x : samples.points) {
        u.push_back(x.u);
    }
    return std::max(end_of(u, w.band, w.away, scale.spacing) - w.band, w.band + 6 * scale.spacing);
}

// The same along the seam, each way; the samples beyond are left out.
Samples within_ends(const Samples& samples, const ScanScale& scale, const SectionWindow& w) {
    Samples kept;
    kept.share = samples.share;
    double reach[2];
    for (const int way : {0, 1}) {
        std::vector<double> s;
        for (const Sample& x : samples.points) {
            if ((x.s < 0) == (way == 0)) {
                s.push_back(std::abs(x.s));
            }
        }
        reach[way] = std::max(end_of(s, 0, w.along, scale.spacing) - w.band, 3 * scale.spacing);
    }
    std::copy_if(samples.points.begin(), samples.points.end(), std::back_inserter(kept.points),
                 [&](const Sample& x) { return x.s >= -reach[0] && x.s <= reach[1]; });
    return kept;
}

// The flank in the largest window within the limit in which one surface explains what it holds; mostly that is the limit.
std::optional<Flank> fit_flank(const Samples& samples, const ScanScale& scale, SectionWindow limit) {
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
    const Samples inside = within_ends(samples, scale, limit);
    auto begun = begin_flank(inside, scale, flank.noise, limit);
    if (begun) {
        begun->edge = flank.edge;
        grow(*begun, inside, scale, limit);
    }
    return begun;
}

// The same for a wider window, from a fit of a smaller one.
void widen(Flank& flank, const Samples& samples, const ScanScale& scale, SectionWindow window) {
    window.away = std::min(window.away, flank.edge);
    SectionWindow limit = within_reach(flank, window, flank.noise, scale.correlation);
    limit.away = std::max(limit.away, flank.window.away);
    limit.along = std::max(limit.along, flank.window.along);
    if (!take_whole(flank, samples, scale, limit, true)) {
        grow(flank, samples, scale, window);
    }
}

// Variance of the means of blocks of residuals over that of as many independent ones. Blocks are much wider than noise is
// correlated; what they share is also whatever bends the surface by less than the tests of its shape see.
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

// 1-sigma of one point as far as means over many go. Thinned by lot, noise that neighbours shared is less of a share of what
// is left.
double unit_of_means(const Flank& flank, const ScanScale& scale) {
    return flank.fit.scale() * std::sqrt(std::max(1 + flank.share * (scale.correlation - 1), shared_variance(flank.fit)));
}

void finish_flank(Flank& flank, const ScanScale& scale, double u) {
    const SectionWindow& w = flank.window;
    const auto& c = flank.fit.coefficients();
    const double x = u / w.away;
    flank.height = flank.fit.value(x, 0);
    flank.slope = (c[1] + 2 * c[3] * x) / w.away;
    flank.slope_along = (c[2] + c[4] * x) / w.along;
    const auto row = QuadraticFit::row(x, 0);
    flank.sigma = std::sqrt(row.dot(flank.fit.cofactors() * row)) * unit_of_means(flank, scale);
    const double slab = std::max(2.5 * scale.spacing, w.along / 8) / w.along;
    double count = 0;
    for (std::size_t i = 0; i < flank.fit.size(); ++i) {
        count += std::abs(flank.fit.s(i)) <= slab && flank.fit.weight(i) > 0;
    }
    flank.slab_points = count / flank.share / (2 * slab * w.along) / (w.away - w.band);
}

// As much as bends and corners allow to be seen without knowing of them.
SectionWindow first_window(const ScanScale& scale, const SectionWindow& window) {
    const SectionWindow follow = following_window(scale);
    return {std::min(window.along, follow.along), std::min(window.away, follow.away), window.band};
}

std::optional<FirstLook> first_look(const PointGrid& grid, const ScanScale& scale, const Frame& f, const SectionWindow& window) {
    const SectionWindow near = first_window(scale, window);
    const auto samples = gather(grid, scale, f, near, nullptr);
    FirstLook look;
    for (std::size_t k = 0; k < 2; ++k) {
        auto flank = fit_flank(samples[k], scale, near);
        if (!flank) {
            return std::nullopt;
        }
        look[k] = std::move(*flank);
    }
    return look;
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

std::optional<SectionFit> fit_section(const PointGrid& grid, const ScanScale& scale, const Section& guess, const SectionWindow& window) {
    const auto frame = frame_of(guess);
    if (!frame) {
        return std::nullopt;
    }
    const Frame& f = *frame;
    auto look = first_look(grid, scale, f, window);
    if (!look) {
        return std::nullopt;
    }
    const SectionWindow seen = first_window(scale, window);
    if (window.along > seen.along || window.away > seen.away) {
        const auto samples = gather(grid, scale, f, window, &*look);
        for (std::size_t k = 0; k < 2; ++k) {
            widen((*look)[k], samples[k], scale, window);
        }
    }
    SectionFit result;
    for (std::size_t k = 0; k < 2; ++k) {
        result.flank[k] = std::move((*look)[k]);
        result.flank[k].fit.shrink(unit_of_means(result.flank[k], scale));
    }
    // Newton's method in the section plane on u1 d1 + f1(u1) n1 = u2 d2 + f2(u2) n2.
    Eigen::Vector2d u(0, 0);
    const auto value = [&](int k) { return result.flank[k].fit.value(u[k] / result.flank[k].window.away, 0); };
    const auto slope = [&](int k) {
        const auto& c = result.flank[k].fit.coefficients();
        const double away = result.flank[k].window.away;
        return (c[1] + 2 * c[3] * u[k] / away) / away;
    };
    for (int iteration = 0; iteration < 20; ++iteration) {
        const Eigen::Vector3d gap = u[0] * f.d[0] + value(0) * f.n[0] - u[1] * f.d[1] - value(1) * f.n[1];
        const Eigen::Vector3d c0 = f.d[0] + slope(0) * f.n[0], c1 = f.d[1] + slope(1) * f.n[1];
        Eigen::Matrix2d J;
        J << f.d[0].dot(c0), -f.d[0].dot(c1), f.n[0].dot(c0), -f.n[0].dot(c1);
        const Eigen::Vector2d step = -J.partialPivLu().solve(Eigen::Vector2d(f.d[0].dot(gap), f.n[0].dot(gap)));
        if (!step.allFinite() || (u + step).cwiseAbs().maxCoeff() > window.away) {
            return std::nullopt;
        }
        u += step;
        if (step.cwiseAbs().maxCoeff() < 1e-12 * window.away) {
            break;
        }
    }
    Eigen::Vector3d normal[2];
    for (int k = 0; k < 2; ++k) {
        finish_flank(result.flank[k], scale, u[k]);
        normal[k] = (f.n[k] - result.flank[k].slope * f.d[k] - result.flank[k].slope_along * f.t).normalized();
    }
    const Eigen::Vector3d offset = u[0] * f.d[0] + result.flank[0].height * f.n[0];
    const Eigen::Vector3d axis = normal[0].cross(normal[1]);
    result.section = {f.p + offset, normal[0], normal[1]};
    result.t = axis.normalized();
    result.bend = std::atan2(axis.norm(), normal[0].dot(normal[1]));
    result.shift = offset.norm();
    result.sigma = std::hypot(result.flank[0].sigma, result.flank[1].sigma) / std::max(1e-6, axis.norm());
    if (result.t.dot(f.t) < 0.5 || !result.section.p.allFinite()) {
        return std::nullopt;
    }
    return result;
}

std::optional<SectionFit> settle_section(const PointGrid& grid, const ScanScale& scale, const Section& guess, const SectionWindow& window, int rounds) {
    auto fit = fit_section(grid, scale, guess, window);
    const Eigen::Vector3d start = guess.p;
    for (int round = 1; round < rounds && fit; ++round) {
        const double before = fit->shift;
        // Keep to the section plane of the first guess, so that the point does not wander along the seam.
        Section next = fit->section;
        fit = fit_section(grid, scale, next, window);
        if (fit && fit->shift < std::max(0.1 * fit->sigma, 1e-3 * scale.noise)) {
            break;
        }
        if (fit && round > 2 && fit->shift > before) {
            break;
        }
    }
    if (fit) {
        fit->shift = (fit->section.p - start).norm();
    }
    return fit;
}

}  // namespace seampath
