#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>

#include "stages/geometry/groove_section.hpp"

namespace seampath {
namespace {

constexpr double kSquare = 8 * std::numbers::pi / 180;  // a side more upright than this has no bevel
constexpr double kDeep = 0.8;         // quantile of the depths at which an end is seen: shadows only make them less
constexpr double kApart = 3;          // sigmas
constexpr double kLeastNoise = 0.02;  // mm
constexpr double kHidden = 0.5;       // share of the places that must see an end for it to be known by itself

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
struct Level {
    double depth = 0, variance = 0;
    double scatter = 0;  ///< mm, of the depths that it is the middle of
    double share = 0;    ///< of the places, that saw it
    std::vector<double> views;

    bool holds(const BevelDepth& seen) const {
        return std::abs(seen.depth - depth) < kApart * std::max({scatter, seen.sigma, kLeastNoise});
    }
};

std::optional<Level> level_of(std::span<const GrooveFit> fits, std::size_t k, double step, double window) {
    std::vector<double> depths;
    for (const GrooveFit& fit : fits) {
        if (fit.seen[k]) {
            depths.push_back(fit.seen[k]->depth);
        }
    }
    if (depths.empty()) {
        return std::nullopt;
    }
    Level level;
    level.depth = quantile(depths, kDeep);
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
        level.variance = std::pow(std::max(level.scatter, kLeastNoise), 2) / independent;
    }
    double count = 0;
    for (const GrooveFit& fit : fits) {
        if (fit.seen[k] && level.holds(*fit.seen[k])) {
            level.views.resize(std::max(level.views.size(), fit.seen[k]->share.size()), 0);
            for (std::size_t v = 0; v < fit.seen[k]->share.size(); ++v) {
                level.views[v] += fit.seen[k]->share[v];
            }
            count += 1;
        }
    }
    for (double& share : level.views) {
        share /= std::max(1.0, count);
    }
    return level;
}

// What a place keeps of its own: as far as depths scatter by more than noise.
BevelDepth lower_end(const std::optional<BevelDepth>& seen, const Level& level) {
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
bool meets(std::span<const GrooveFit> fits, const Level& level, std::size_t k) {
    std::vector<double> depths;
    for (const GrooveFit& fit : fits) {
        depths.push_back(crossing_depth(fit, k));
    }
    return std::abs(quantile(depths, 0.5) - level.depth) < kApart * std::sqrt(level.variance) + 2 * kLeastNoise;
}

}  // namespace

std::optional<GrooveRoot> pool_roots(std::span<GrooveFit> fits, double step, double window) {
    share_angle(fits, 0, step, window);
    share_angle(fits, 1, step, window);
    std::array<std::optional<Level>, 2> level{level_of(fits, 0, step, window), level_of(fits, 1, step, window)};
    if (fits.empty() || (!level[0] && !level[1])) {
        return std::nullopt;
    }
    GrooveRoot root;
    constexpr int kMismatch = 3, kBevel1 = 4;
    for (GrooveFit& fit : fits) {
        for (std::size_t k = 0; k < 2; ++k) {
            const Level& known = level[k] ? *level[k] : *level[1 - k];
            fit.lower[k] = lower_end(fit.seen[k], known);
        }
    }
    for (int k = 0; k < 2; ++k) {
        if (median(fits, {}, kBevel1 + k) < kSquare) {
            root.square = k;
        }
    }
    // The end of the lower plate's bevel may lie in the shadow of the higher one's edge; plates are prepared alike.
    const double mismatch = median(fits, {}, kMismatch);
    const std::size_t low = mismatch > 0 ? 0 : 1;
    const bool hidden = !level[low] || (level[1 - low] &&
                                        level[1 - low]->depth - level[low]->depth >
                                            kApart * std::sqrt(level[0]->variance + level[1]->variance) &&
                                        level[1 - low]->depth - level[low]->depth < std::abs(mismatch));
    if (!root.square && hidden && level[1 - low]) {
        root.as_other[low] = true;
        for (GrooveFit& fit : fits) {
            fit.lower[low] = lower_end(std::nullopt, *level[1 - low]);
        }
    }
    root.closed = !root.square && !root.as_other[low] && meets(fits, *level[0], 0) && meets(fits, *level[1], 1);
    return root;
}

}  // namespace seampath
