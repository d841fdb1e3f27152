#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "stages/geometry/groove_section.hpp"

namespace seampath {
namespace {

constexpr double kDeep = 0.8;           // quantile of the depths at which an end is seen: shadows only make them less
constexpr double kApart = 3;            // sigmas
constexpr double kLeastScatter = 0.02;  // mm
constexpr double kWidestRoot = 4;  // mm; ISO 9692-1 has no wider gap at the root of V, Y, U and single-bevel grooves

// Gives the bevels of side k what all places tell of its angle, as far as it varies by no more than noise: the lines
// of places that see little of the bevel are carried on further than they know themselves.
void share_angle(std::span<GrooveFit> fits, std::size_t k, double step, double window) {
    using Row = Eigen::RowVector3d;
    std::vector<Row> by(fits.size());  // of the angle, by the line's coefficients
    std::vector<double> angle(fits.size()), variance(fits.size());
    for (std::size_t i = 0; i < fits.size(); ++i) {
        const GrooveFace& face = fits[i].bevel[k];
        const double middle = 0.5 * (face.along(fits[i].shape.corner[k]) + face.along(fits[i].shape.end[k]));
        by[i] = -Row(0, 1 / face.length, 2 * middle / (face.length * face.length));
        angle[i] = bevel_angle(fits[i], k, middle);
        variance[i] = by[i] * face.covariance * by[i].transpose();
    }
    std::vector<double> sorted = variance, sure, off, noises;
    const double most = 2 * quantile(sorted, 0.25);
    for (std::size_t i = 0; i < fits.size(); ++i) {
        if (variance[i] <= most) {
            sure.push_back(angle[i]);
            noises.push_back(variance[i]);
        }
    }
    const double whole = quantile(sure, 0.5);
    for (const double x : sure) {
        off.push_back(std::abs(x - whole));
    }
    const double scatter = std::pow(1.4826 * quantile(off, 0.5), 2), noise = quantile(noises, 0.5);
    const double independent = std::max(1.0, static_cast<double>(sure.size()) * step / window);
    const double prior = std::max(0.0, scatter - noise) + std::max(scatter, noise) / independent;
    for (std::size_t i = 0; i < fits.size(); ++i) {
        GrooveFace& face = fits[i].bevel[k];
        const Eigen::Vector3d gain = face.covariance * by[i].transpose() / (variance[i] + prior);
        const Eigen::Matrix3d kept = Eigen::Matrix3d::Identity() - gain * by[i];
        face.c += gain * (whole - angle[i]);
        face.covariance = kept * face.covariance;
        for (Eigen::Vector3d& shift : face.shift) {
            shift = kept * shift;
        }
    }
}

/// Of one side, along the groove.
struct BevelLevel {
    double depth = 0, variance = 0;
    double scatter = 0;  ///< mm, of the depths that it is the middle of
    double share = 0;    ///< of the places, that saw it
    double turned = 0;   ///< of those, the share that saw the root face below it
    std::vector<double> views;

    bool holds(const BevelDepth& seen) const {
        return std::abs(seen.depth - depth) < kApart * std::max({scatter, seen.sigma, kLeastScatter});
    }
};

// About the depth `start`.
BevelLevel level_about(double start, std::span<const GrooveFit> fits, std::size_t k, double step, double window) {
    BevelLevel level;
    level.depth = start;
    for (int round = 0; round < 4; ++round) {
        std::vector<double> near, off;
        for (const GrooveFit& fit : fits) {
            if (fit.seen[k] && level.holds(*fit.seen[k])) {
                near.push_back(fit.seen[k]->depth);
            }
        }
        if (near.empty()) {
            break;
        }
        level.depth = quantile(near, 0.5);
        for (const double x : near) {
            off.push_back(std::abs(x - level.depth));
        }
        level.scatter = 1.4826 * quantile(off, 0.5);
        level.share = static_cast<double>(near.size()) / static_cast<double>(fits.size());
        const double independent = std::max(1.0, static_cast<double>(near.size()) * step / window);
        level.variance = std::pow(std::max(level.scatter, kLeastScatter), 2) / independent;
    }
    double count = 0;
    for (const GrooveFit& fit : fits) {
        if (fit.seen[k] && level.holds(*fit.seen[k])) {
            level.views.resize(std::max(level.views.size(), fit.seen[k]->share.size()), 0);
            for (std::size_t v = 0; v < fit.seen[k]->share.size(); ++v) {
                level.views[v] += fit.seen[k]->share[v];
            }
            level.turned += fit.seen[k]->turns;
            count += 1;
        }
    }
    level.turned /= std::max(1.0, count);
    for (double& share : level.views) {
        share /= std::max(1.0, count);
    }
    return level;
}

// The deepest that enough places agree on: what few see deeper, and most as surely less deep, are strays below the end.
std::optional<BevelLevel> level_of(std::span<const GrooveFit> fits, std::size_t k, double step, double window) {
    constexpr double kMost = 2.5;  // over the places of the deepest
    constexpr double kAsSure = 3;  // in scatter
    std::vector<double> depths;
    for (const GrooveFit& fit : fits) {
        if (fit.seen[k]) {
            depths.push_back(fit.seen[k]->depth);
        }
    }
    if (depths.empty()) {
        return std::nullopt;
    }
    const BevelLevel deepest = level_about(quantile(depths, kDeep), fits, k, step, window),
                     usual = level_about(quantile(depths, 0.5), fits, k, step, window);
    return usual.share > kMost * deepest.share && usual.scatter < kAsSure * std::max(deepest.scatter, kLeastScatter)
               ? usual
               : deepest;
}

// What a place keeps of its own: as far as depths scatter by more than noise.
BevelDepth lower_end(const std::optional<BevelDepth>& seen, const BevelLevel& level) {
    BevelDepth lower{level.depth, 0, level.views};
    if (seen && level.holds(*seen)) {
        const double noise = seen->sigma * seen->sigma, own = std::max(0.0, level.scatter * level.scatter - noise);
        const double share = own / (own + noise);
        lower.depth += share * (seen->depth - level.depth);
        lower.sigma = std::sqrt(share * noise + level.variance);
    } else {
        lower.sigma = std::sqrt(level.scatter * level.scatter + level.variance);
    }
    return lower;
}

double median(std::span<const GrooveFit> fits, const GrooveRoot& root, int number) {
    std::vector<double> values;
    for (const GrooveFit& fit : fits) {
        values.push_back(numbers_of(fit, root)->value[number]);
    }
    return quantile(values, 0.5);
}

// Whether a side's bevel ends where it runs into the other's.
bool meets(std::span<const GrooveFit> fits, const BevelLevel& level, std::size_t k) {
    std::vector<double> depths;
    for (const GrooveFit& fit : fits) {
        depths.push_back(crossing_depth(fit, k));
    }
    return std::abs(quantile(depths, 0.5) - level.depth) < kApart * std::sqrt(level.variance) + 2 * kLeastScatter;
}

// Whether a bevel's end is that of the other plate's shadow: less deep than the other bevel's. Plates are prepared
// alike, to the same depth below their tops, or where unlike plates lie flush on their roots, to the same height.
// `higher`: by how much the other top is higher.
bool is_shadow(const BevelLevel& level, const BevelLevel& other, double higher) {
    const double sure = kApart * std::sqrt(level.variance + other.variance) + 2 * kLeastScatter,
                 less = other.depth - level.depth;
    return level.turned < 0.5 && less > sure && std::abs(less - higher) > sure;
}

bool seen_by_two_views(const BevelLevel& level) {
    constexpr double kLeastShare = 0.06;  // of a view that is a quarter as sure as the others
    return std::count_if(level.views.begin(), level.views.end(), [](double x) { return x > kLeastShare; }) > 1;
}

// Whether an end that is less deep than the other one is nothing but a single view's: it may lie as high as the other
// by chance.
bool may_be_shadow(const BevelLevel& level, const BevelLevel& other) {
    return is_shadow(level, other, 0) && !seen_by_two_views(level);
}

// Whether a second witness tells of an end: the root face below it, another view, or the other bevel, which ends about
// as deep.
bool confirmed(const BevelLevel& level, const std::optional<BevelLevel>& other) {
    constexpr double kAlike = 0.05;  // of the depth
    constexpr double kTurned = 0.3;  // of the places
    return level.turned > kTurned || seen_by_two_views(level) ||
           (other && std::abs(other->depth - level.depth) < kAlike * level.depth);
}

// All of the bevels below what is seen of them may lie in shadow.
void doubt_ends(std::span<GrooveFit> fits) {
    for (GrooveFit& fit : fits) {
        for (std::size_t k = 0; k < 2; ++k) {
            fit.lower[k].sigma = std::hypot(fit.lower[k].sigma, crossing_depth(fit, k) - fit.lower[k].depth);
        }
    }
}

}  // namespace

std::optional<GrooveRoot> pool_roots(std::span<GrooveFit> fits, double step, double window) {
    share_angle(fits, 0, step, window);
    share_angle(fits, 1, step, window);
    std::array<std::optional<BevelLevel>, 2> level{level_of(fits, 0, step, window), level_of(fits, 1, step, window)};
    if (fits.empty() || (!level[0] && !level[1])) {
        return std::nullopt;
    }
    GrooveRoot root;
    constexpr int kGap = 2, kMismatch = 3, kBevel1 = 4;
    for (GrooveFit& fit : fits) {
        for (std::size_t k = 0; k < 2; ++k) {
            const BevelLevel& known = level[k] ? *level[k] : *level[1 - k];
            fit.lower[k] = lower_end(fit.seen[k], known);
        }
    }
    for (int k = 0; k < 2; ++k) {
        if (median(fits, {}, kBevel1 + k) < kSquareSide) {
            root.square = k;
        }
    }
    const double mismatch = median(fits, {}, kMismatch);
    for (std::size_t k = 0; k < 2 && !root.square; ++k) {
        if (level[1 - k] && (!level[k] || is_shadow(*level[k], *level[1 - k], k == 0 ? mismatch : -mismatch))) {
            root.as_other[k] = true;
            for (GrooveFit& fit : fits) {
                fit.lower[k] = lower_end(std::nullopt, *level[1 - k]);
            }
        }
    }
    const auto known = [&](std::size_t k) { return *level[root.as_other[k] ? 1 - k : k]; };
    root.closed = !root.square && meets(fits, known(0), 0) && meets(fits, known(1), 1);
    const auto deepest = root.square ? static_cast<std::size_t>(1 - *root.square)
                                     : static_cast<std::size_t>(!level[0] || root.as_other[0]);
    root.unseen = !root.closed && (median(fits, root, kGap) > kWidestRoot || !level[deepest] ||
                                   !confirmed(*level[deepest], root.square ? std::nullopt : level[1 - deepest]));
    for (std::size_t k = 0; k < 2 && !root.square && !root.closed; ++k) {
        root.unseen =
            root.unseen || (level[k] && level[1 - k] && !root.as_other[k] && may_be_shadow(*level[k], *level[1 - k]));
    }
    if (root.unseen) {
        doubt_ends(fits);
    }
    return root;
}

}  // namespace seampath
