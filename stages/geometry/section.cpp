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
constexpr int kBins = 5;
constexpr std::size_t kLeastPoints = 24;

struct Sample {
    float u, s, z;
    std::uint32_t lot;      // the same for the same point, in whatever order the points came
};

// More points than this to a flank add time and, their noise being shared, nothing to the fit: lots are drawn.
constexpr std::size_t kEnoughPoints = 12000;

// Keeps a share of the samples, chosen by lot; the share is returned.
double thin_out(std::vector<Sample>& samples) {
    const double share = std::min(1.0, static_cast<double>(kEnoughPoints) / static_cast<double>(std::max<std::size_t>(1, samples.size())));
    if (share < 1) {
        const auto limit = static_cast<std::uint32_t>(share * 4294967295.0);
        std::erase_if(samples, [limit](const Sample& x) { return x.lot > limit; });
    }
    return share;
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

// Points of both flanks within the window. The gate is a wedge: it opens with the distance from the seam, so that a guess a
// few degrees off still sees its flank, but never reaches the other flank.
std::array<std::vector<Sample>, 2> gather(const PointGrid& grid, const ScanScale& scale, const Frame& f, const SectionWindow& w) {
    std::array<std::vector<Sample>, 2> samples;
    const double opening = std::numbers::pi - std::atan2(f.n[0].cross(f.n[1]).norm(), f.n[0].dot(f.n[1]));
    const double slope = std::tan(std::min(0.3 * opening, kGateSlope)), base = 4 * scale.noise + scale.spacing;
    // The box of the two flank rectangles.
    Eigen::Vector3d low = f.p, high = f.p;
    for (int k = 0; k < 2; ++k) {
        for (const double u : {0.0, w.away}) {
            for (const double s : {-w.along, w.along}) {
                for (const double z : {-1.0, 1.0}) {
                    const Eigen::Vector3d corner = f.p + u * f.d[k] + s * f.t + z * (base + slope * u) * f.n[k];
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
            for (int k = 0; k < 2; ++k) {
                const double u = v.dot(f.d[k]), z = v.dot(f.n[k]);
                if (u >= w.band && u <= w.away && std::abs(z) <= base + slope * u) {
                    samples[static_cast<std::size_t>(k)].push_back({static_cast<float>(u), static_cast<float>(s), static_cast<float>(z), lot_of(q)});
                }
            }
        }
    });
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

// Fits the samples of one window. `inner`, when given, is the fit of a smaller window: what lies off its continuation belongs
// to something else, a step, an edge, another wall.
std::optional<QuadraticFit> fit_window(const std::vector<Sample>& samples, const SectionWindow& w, double noise, const Flank* inner) {
    QuadraticFit fit;
    fit.begin(samples.size());
    for (const Sample& x : samples) {
        if (x.u < w.band || x.u > w.away || std::abs(x.s) > w.along) {
            continue;
        }
        if (inner) {
            const double beyond = std::max({0.0, x.u - inner->window.away, std::abs(x.s) - inner->window.along});
            const double z = inner->fit.value(x.u / inner->window.away, x.s / inner->window.along);
            if (std::abs(x.z - z) > 4 * noise + kContinuation * beyond) {
                continue;
            }
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
std::optional<Flank> begin_flank(const std::vector<Sample>& samples, const ScanScale& scale, double noise, const SectionWindow& limit) {
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

// How far a surface of curvature 2 |c| / extent^2 is still a parabola: the circle's next term, k^3 x^4 / 8, is to stay below
// a third of the noise. Only curvature that the fit is sure of counts.
double parabola_reach(double c, double sigma, double extent, double noise) {
    const double k = 2 * std::max(0.0, std::abs(c) - 2 * sigma) / (extent * extent);
    return k > 0 ? std::pow(8 * 0.3 * noise / (k * k * k), 0.25) : std::numeric_limits<double>::infinity();
}

SectionWindow within_parabola(const Flank& flank, const SectionWindow& limit, double noise, double correlation) {
    const QuadraticFit::Normal cofactors = flank.fit.cofactors();
    const double unit = flank.fit.scale() * std::sqrt(correlation);
    const auto& c = flank.fit.coefficients();
    const SectionWindow& w = flank.window;
    return {std::min(limit.along, parabola_reach(c[5], unit * std::sqrt(cofactors(5, 5)), w.along, noise)),
            std::min(limit.away, parabola_reach(c[3], unit * std::sqrt(cofactors(3, 3)), w.away, noise)), limit.band};
}

// Noise of this very surface, which may be seen at more of a slant than the place as a whole: scatter of the points about the
// means of small bins, so that a bend does not pass for noise.
double flank_noise(const std::vector<Sample>& samples, const ScanScale& scale, const SectionWindow& limit) {
    constexpr std::size_t kAcross = 4;
    constexpr double kMost = 2.5;      // of the place's noise; what is rougher is another surface, or none
    const double least = std::max(scale.noise, 0.02 * scale.spacing);
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

// The largest window within the limit in which one quadratic explains what it holds. Mostly the limit itself does; else the
// window grows from the smallest, across and along in turn: where it ends, the surface ends or turns.
std::optional<Flank> fit_flank(const std::vector<Sample>& samples, const ScanScale& scale, SectionWindow limit) {
    const double noise = flank_noise(samples, scale, limit);
    for (int attempt = 0; attempt < 2; ++attempt) {
        Flank whole;
        whole.window = limit;
        whole.noise = noise;
        auto fit = fit_window(samples, limit, noise, nullptr);
        if (!fit || !quality_of(*fit, limit, noise, scale.correlation).good() || fit->share_taken() < kMostTaken) {
            break;
        }
        whole.fit = std::move(*fit);
        const SectionWindow reach = within_parabola(whole, limit, noise, scale.correlation);
        if (attempt == 1 || (reach.away >= 0.9 * limit.away && reach.along >= 0.9 * limit.along)) {
            return whole;
        }
        limit.away = std::max(reach.away, std::min(limit.away, smallest_window(scale).away));
        limit.along = std::max(reach.along, std::min(limit.along, smallest_window(scale).along));
    }
    auto flank = begin_flank(samples, scale, noise, limit);
    if (!flank) {
        return std::nullopt;
    }
    bool across = true, along = true;
    while ((across && flank->window.away < limit.away) || (along && flank->window.along < limit.along)) {
        for (const bool widen_across : {true, false}) {
            bool& open = widen_across ? across : along;
            double SectionWindow::*const extent = widen_across ? &SectionWindow::away : &SectionWindow::along;
            if (!open || flank->window.*extent >= limit.*extent) {
                continue;
            }
            SectionWindow w = flank->window;
            w.*extent = std::min({limit.*extent, w.*extent * kGrow, within_parabola(*flank, limit, noise, scale.correlation).*extent});
            if (w.*extent < 1.1 * flank->window.*extent) {
                open = false;
                continue;
            }
            auto fit = fit_window(samples, w, noise, &*flank);
            const Quality q = fit ? quality_of(*fit, w, noise, scale.correlation) : Quality{2, 2, false, true};
            if (q.good()) {
                flank->window = w;
                flank->fit = std::move(*fit);
            } else {
                open = false;
            }
        }
    }
    return flank;
}

// 1-sigma of one point as far as means over many go. Thinned by lot, noise that neighbours shared is less of a share of what
// is left.
double unit_of_means(const Flank& flank, const ScanScale& scale) {
    return flank.fit.scale() * std::sqrt(1 + flank.share * (scale.correlation - 1));
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

}  // namespace

SectionWindow following_window(const ScanScale& scale) {
    const SectionWindow least = smallest_window(scale);
    const double wider = std::clamp(std::sqrt(scale.correlation), 2.2, 3.0);
    return {wider * least.along, wider * least.away, least.band};
}

SectionWindow measuring_window(const ScanScale& scale) {
    const SectionWindow follow = following_window(scale);
    return {2.4 * follow.along, 1.7 * follow.away, follow.band};
}

std::optional<SectionFit> fit_section(const PointGrid& grid, const ScanScale& scale, const Section& guess, const SectionWindow& window) {
    const auto frame = frame_of(guess);
    if (!frame) {
        return std::nullopt;
    }
    const Frame& f = *frame;
    auto samples = gather(grid, scale, f, window);
    SectionFit result;
    for (int k = 0; k < 2; ++k) {
        const double share = thin_out(samples[static_cast<std::size_t>(k)]);
        auto flank = fit_flank(samples[static_cast<std::size_t>(k)], scale, window);
        if (!flank) {
            return std::nullopt;
        }
        result.flank[k] = std::move(*flank);
        result.flank[k].share = share;
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
