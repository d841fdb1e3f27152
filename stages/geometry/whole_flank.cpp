#include "stages/geometry/whole_flank.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "stages/geometry/robust.hpp"

namespace seampath {
namespace {

constexpr double kMostScale = 1.3;       // of its residuals, in those of the windows' own surfaces
constexpr double kMedianSquare = 0.455;  // median of the square of a normal variable
constexpr double kRipple = 0.25;         // of its noise, rms, by which a scanner bends smooth surfaces
constexpr double kStandsOut = 16;        // squared: a place this many variances off the surface is of another one
constexpr double kMostAstray = 9;        // squared, of a window's surface off the whole one, in variances of both

/// Normal equations of a polynomial of the residuals over the distance from the seam.
struct Profile {
    static constexpr int kTerms = 3;
    using Vector = Eigen::Matrix<double, kTerms, 1>;
    using Matrix = Eigen::Matrix<double, kTerms, kTerms>;

    Matrix A = Matrix::Zero();
    Vector b = Vector::Zero();

    static Vector row(double u) { return {1, u, u * u}; }
    void add(double u, double r, double w) {
        A += w * row(u) * row(u).transpose();
        b += w * r * row(u);
    }
    Profile& operator+=(const Profile& o) {
        A += o.A, b += o.b;
        return *this;
    }
};

/// How the flank bends off the surface across the seam, alike along all of it: by how much at the seam, mm.
struct Bend {
    Profile::Vector c = Profile::Vector::Zero();
    double variance = 0;  ///< of c[0], mm^2
};

// The quadratic term is shrunk by its share of noise, which blocks of points may share; the others follow it.
Bend bend_of(const FlankPool& pool, const SurfaceFit& surface, double unit_u) {
    Profile all;
    std::vector<Profile::Vector> influence;
    for (std::size_t i = 0; i < pool.points.size(); ++i) {
        all.add(pool.u[i] / unit_u, surface.distance(pool.points[i]), surface.weight(pool.points[i]));
    }
    const Profile::Matrix cofactors = all.A.ldlt().solve(Profile::Matrix::Identity());
    const Profile::Vector c = cofactors * all.b;
    for (std::size_t i = 0; i < pool.points.size(); ++i) {
        const Profile::Vector row = Profile::row(pool.u[i] / unit_u);
        if (pool.station_block[i] >= influence.size()) {
            influence.resize(pool.station_block[i] + 1, Profile::Vector::Zero());
        }
        influence[pool.station_block[i]] +=
            surface.weight(pool.points[i]) * (surface.distance(pool.points[i]) - row.dot(c)) * row;
    }
    double variance = 0;
    for (const auto& g : influence) {
        variance += std::pow(cofactors.row(2).dot(g), 2);
    }
    const auto blocks = static_cast<double>(influence.size());
    variance =
        variance * blocks / std::max(1.0, blocks - 3) + std::pow(kRipple * surface.scale() * 6 * std::sqrt(5.0), 2);
    const double prior = std::max(0.0, c[2] * c[2] - variance), share = prior / std::max(1e-300, prior + variance);
    Bend bend;
    bend.c[2] = share * c[2];
    const Eigen::Vector2d lead = all.A.topLeftCorner<2, 2>().ldlt().solve(all.A.topRightCorner<2, 1>());
    bend.c.head<2>() = c.head<2>() + lead * (c[2] - bend.c[2]);
    bend.variance = lead[0] * lead[0] * share * variance;
    return bend;
}

// Share of the points of the places nearby that have a weight at all.
std::vector<double> taken_about(std::size_t places, std::size_t reach, const FlankPool& pool,
                                const SurfaceFit& surface) {
    std::vector<double> all(places, 0), taken(places, 0), share;
    for (std::size_t i = 0; i < pool.points.size(); ++i) {
        all[pool.place[i]] += 1;
        taken[pool.place[i]] += surface.weight(pool.points[i]) > 0;
    }
    for (std::size_t i = 0; i < places; ++i) {
        double here = 0, of_all = 0;
        for (std::size_t j = i > reach ? i - reach : 0; j < std::min(places, i + reach + 1); ++j) {
            here += taken[j];
            of_all += all[j];
        }
        share.push_back(of_all > 0 ? here / of_all : 0);
    }
    return share;
}

// Straight lines through what is left of the residuals, over the distance from the seam, each of the places nearby.
std::vector<std::optional<Departure>> departures(std::size_t places, std::size_t reach, const FlankPool& pool,
                                                 const SurfaceFit& surface, const Bend& bend, double unit_u) {
    std::vector<Profile> at(places);
    for (std::size_t i = 0; i < pool.points.size(); ++i) {
        const double u = pool.u[i] / unit_u;
        at[pool.place[i]].add(u, surface.distance(pool.points[i]) - Profile::row(u).dot(bend.c),
                              surface.weight(pool.points[i]));
    }
    const double variance = surface.scale() * surface.scale() * pool.correlation;
    std::vector<std::optional<Departure>> found(places);
    for (std::size_t i = 0; i < places; ++i) {
        Profile sum;
        for (std::size_t j = i > reach ? i - reach : 0; j < std::min(places, i + reach + 1); ++j) {
            sum += at[j];
        }
        const Eigen::Matrix2d A = sum.A.topLeftCorner<2, 2>();
        if (A(0, 0) > 10 && A.determinant() > 1e-6 * A(0, 0) * A(1, 1)) {
            const Eigen::Matrix2d cofactors = A.inverse();
            found[i] = {cofactors.row(0).dot(sum.b.head<2>()), variance * cofactors(0, 0)};
        }
    }
    return found;
}

// How much of the modelled variance the departures show as noise: by second differences of windows side by side, which
// do not see waves longer than they. What the scan shows from window to window is its surface, whoever bent it.
double noise_share(const std::vector<std::optional<Departure>>& found, std::size_t lag) {
    constexpr double kLeast = 0.02, kMost = 4;
    constexpr std::size_t kEnough = 4;
    std::vector<double> ratio;
    for (std::size_t i = lag; i + lag < found.size(); ++i) {
        const auto &a = found[i - lag], &b = found[i], &c = found[i + lag];
        if (a && b && c) {
            const double difference = a->value - 2 * b->value + c->value;
            ratio.push_back(difference * difference / (a->variance + 4 * b->variance + c->variance));
        }
    }
    return ratio.size() < kEnough ? 1 : std::clamp(quantile(ratio, 0.5) / kMedianSquare, kLeast, kMost);
}

WholeFlank shrunk(std::span<const FlankPlace> places, const FlankPool& pool, std::size_t reach,
                  const SurfaceFit& surface) {
    std::vector<double> sorted = pool.u;
    const double unit_u = quantile(sorted, 0.9);
    const Bend bend = bend_of(pool, surface, unit_u);
    auto found = departures(places.size(), reach, pool, surface, bend, unit_u);
    const double noise = noise_share(found, 2 * reach + 1);
    std::vector<double> squares, variances;
    for (auto& d : found) {
        if (d) {
            d->variance *= noise;
            squares.push_back(d->value * d->value);
            variances.push_back(d->variance);
        }
    }
    // A median of few independent values is unsure itself: what it exceeds noise by must exceed that, too.
    const double independent = static_cast<double>(places.size()) / static_cast<double>(2 * reach + 1);
    const double by_noise = quantile(variances, 0.5) * (1 + 1.5 / std::sqrt(independent));
    const double prior = std::max(0.0, quantile(squares, 0.5) / kMedianSquare - by_noise);
    WholeFlank whole{surface,
                     std::vector<Departure>(places.size(), {bend.c[0], prior}),
                     {},
                     taken_about(places.size(), reach, pool, surface),
                     0};
    std::vector<double> total;
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (found[i]) {
            const auto [value, variance] = *found[i];
            const bool stands_out = value * value > kStandsOut * (prior + variance);
            const double share = stands_out ? 1 : prior / (prior + variance);
            whole.at[i] = {bend.c[0] + share * value, share * variance};
        }
        const double sigma = surface.sigma(places[i].p);
        whole.at[i].variance += sigma * sigma + bend.variance;
        // Both come from the same points, so that the surer one is taken and not a mean of the two; no jump between
        // places. A window far off saw something else: points that depart together stand out of the surface itself.
        const double own = std::pow(places[i].sigma, 2), off = surface.distance(places[i].p) - whole.at[i].value;
        const bool astray = !places[i].measured || off * off > kMostAstray * (own + whole.at[i].variance);
        whole.share.push_back(astray ? 1 : own * own / (own * own + std::pow(whole.at[i].variance, 2)));
        total.push_back(whole.share[i] * whole.at[i].variance + (1 - whole.share[i]) * own);
    }
    whole.variance = quantile(total, 0.5);
    return whole;
}

// Whether the windows' own surfaces lie off this one by more than both are unsure of. Windows know of the noise of
// points, but not that each mixes the views in its own way, which views off each other turn into more: windows side by
// side, `mixed_reach` places to each side, tell by how much.
bool contradicted(std::span<const FlankPlace> places, const WholeFlank& whole, std::optional<std::size_t> mixed_reach) {
    constexpr double kMost = 2;  // robust 1-sigma of the differences, in their own sigmas
    std::vector<std::optional<Departure>> off(places.size());
    std::vector<double> squares;
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (places[i].measured) {
            off[i] = {whole.surface.distance(places[i].p) - whole.at[i].value,
                      std::pow(places[i].sigma, 2) + whole.at[i].variance};
            squares.push_back(off[i]->value * off[i]->value / off[i]->variance);
        }
    }
    const double mixing = mixed_reach ? std::max(1.0, noise_share(off, 2 * *mixed_reach + 1)) : 1;
    return quantile(squares, 0.5) > kMost * kMost * kMedianSquare * mixing;
}

}  // namespace

FlankFit fit_whole_flank(std::span<const FlankPlace> places, const FlankPool& pool, const WholeFlankRules& rules) {
    FlankFit best;
    if (pool.points.size() < rules.least_points || pool.normals.empty()) {
        return best;
    }
    for (const auto& surface : {fit_plane(pool.points, pool.block, pool.normals.front(), rules.least_scale),
                                fit_cylinder(pool.points, pool.block, pool.places, pool.normals, rules.least_scale)}) {
        if (!surface) {
            continue;
        }
        if (!best.whole && (!best.nearest || surface->scale() < best.nearest->scale())) {
            best.nearest = surface;
        }
        if (surface->share_taken() < kLeastExplained || surface->scale() > kMostScale * pool.scale) {
            continue;
        }
        WholeFlank whole = shrunk(places, pool, rules.reach, *surface);
        if ((!best.whole || whole.variance < best.whole->variance) &&
            !contradicted(places, whole, rules.mixes_views ? std::optional(pool.reach) : std::nullopt)) {
            best.nearest = surface;
            best.whole = std::move(whole);
        }
    }
    return best;
}

}  // namespace seampath
